// SPDX-License-Identifier: Apache-2.0
// Requests of any bytes at the live page's server: it answers a good one afterwards, and gives its
// parts to nothing but a GET with a host that is ours. AXG_COUNT: requests.
#include "hil_replay/watch/http_server.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/count.hpp"
#include "tests/support/http_client.hpp"
#include "tests/support/seed.hpp"

namespace axg {
namespace {

/// A request that is mostly right.
class Requests {
  public:
    explicit Requests(std::uint64_t seed) : random_(seed) {}

    std::string next() {
        if (random_() % 4 == 0) {
            return "GET / HTTP/1.1\r\nHost: localhost\r\n\r\n";
        }
        std::string text = pick({"GET", "GET", "GET", "POST", "G", "", "\x00\x01"}) + " " +
                           pick({"/", "/state", "/events", "/../x", "/%", "/%2e%2e/x", "*", ""}) +
                           " " + pick({"HTTP/1.1", "HTTP/1.0", "HTTP/9", "HTCPCP/1.0", ""}) +
                           pick({"\r\n", "\n", "\r", ""});
        for (std::uint64_t i = random_() % 4; i != 0; --i) {
            text += pick({"Host: localhost", "Host: evil.example", "Host:", "Content-Length: -1",
                          "Content-Length: 99999999999999999999", "Transfer-Encoding: chunked",
                          "Connection: upgrade", "Expect: 100-continue", ": ", "X"}) +
                    pick({"\r\n", "\n", ""});
        }
        text += pick({"\r\n", "\r\n", "\n", ""});
        for (std::uint64_t i = random_() % 3; i != 0 && !text.empty(); --i) {
            text[random_() % text.size()] = static_cast<char>(random_());
        }
        return text;
    }

  private:
    std::string pick(std::initializer_list<const char*> words) {
        return *(words.begin() + static_cast<std::ptrdiff_t>(random_() % words.size()));
    }
    std::mt19937_64 random_;
};

TEST(HttpServerProperty, AnyBytesLeaveItServingAndGiveNothingAway) {
    if (!HttpServer::is_built()) {
        GTEST_SKIP() << "skipped: built without libmicrohttpd";
    }
    std::string fault;
    const auto server = HttpServer::start(*read_listen_address("127.0.0.1:0"),
                                          {{"/", {"text/html", "the page"}}}, fault);
    ASSERT_NE(server, nullptr) << fault;
    server->publish("{\"the\":\"state\"}");
    Requests requests(test::printed_seed(20261126));
    const std::uint64_t count = test::count_from_environment(1000);
    std::uint64_t given = 0, refused = 0;
    for (std::uint64_t i = 0; i < count; ++i) {
        const std::string request = requests.next();
        test::HttpClient client(server->port());
        client.say(request);
        const std::string reply = client.take("\r\n\r\n", 20);
        const bool is_given = test::status_of(reply) == 200;
        given += is_given ? 1 : 0;
        refused += reply.empty() || is_given ? 0 : 1;
        if (is_given) {
            EXPECT_TRUE(request.starts_with("GET /") || request.starts_with("\r\n")) << request;
            EXPECT_EQ(request.find("Host: evil.example"), std::string::npos) << request;
        }
        if (i % 100 == 0) {
            ASSERT_EQ(test::status_of(test::get(server->port(), "/")), 200) << request;
        }
    }
    EXPECT_GT(given, 0U);
    EXPECT_GT(refused, count / 20);
    EXPECT_EQ(test::status_of(test::get(server->port(), "/")), 200);
}

}  // namespace
}  // namespace axg
