// SPDX-License-Identifier: Apache-2.0
// The server of the live page over real sockets: what it gives, what it refuses, and that no client
// holds it up.
#include "hil_replay/watch/http_server.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "tests/support/http_client.hpp"

namespace axg {
namespace {

using test::get;
using test::HttpClient;
using test::reply_to;
using test::status_of;

using Clock = std::chrono::steady_clock;

std::int64_t ms_since(Clock::time_point begin) {
    return std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - begin).count();
}

class HttpServerTest : public testing::Test {
  protected:
    void SetUp() override {
        if (!HttpServer::is_built()) {
            GTEST_SKIP() << "skipped: built without libmicrohttpd";
        }
        std::string fault;
        server = HttpServer::start(*read_listen_address("127.0.0.1:0"),
                                   {{"/", {"text/html", "<p>page</p>"}},
                                    {"/live.js", {"text/javascript", std::string(300'000, 'x')}}},
                                   fault);
        ASSERT_EQ(fault, "");
        ASSERT_NE(server, nullptr);
        port = server->port();
    }
    std::unique_ptr<HttpServer> server;
    std::uint16_t port = 0;
};

TEST_F(HttpServerTest, GivesItsPartsAndTheNewestState) {
    const std::string page = get(port, "/");
    EXPECT_EQ(status_of(page), 200);
    EXPECT_NE(page.find("<p>page</p>"), std::string::npos);
    for (const char* header : {"Content-Security-Policy: default-src 'none'; script-src 'self'",
                               "X-Content-Type-Options: nosniff", "Content-Type: text/html"}) {
        EXPECT_NE(page.find(header), std::string::npos) << header;
    }
    EXPECT_EQ(page.find("Access-Control-Allow"), std::string::npos);
    EXPECT_GT(get(port, "/live.js").size(), 300'000U);
    EXPECT_EQ(status_of(get(port, "/state")), 503) << "there is none yet";
    server->publish("{\"n\":1}");
    server->publish("{\"n\":2}");
    EXPECT_NE(get(port, "/state").find("{\"n\":2}"), std::string::npos);
}

TEST_F(HttpServerTest, TakesNoMethodButGet) {
    for (const char* method : {"HEAD", "POST", "PUT", "DELETE", "OPTIONS", "TRACE", "CONNECT",
                               "PATCH", "get", "QUERY"}) {
        const std::string reply =
            reply_to(port, std::string(method) +
                               " / HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n");
        EXPECT_EQ(status_of(reply), 405) << method;
        EXPECT_NE(reply.find("Allow: GET"), std::string::npos) << method;
    }
}

TEST_F(HttpServerTest, TakesNoNameThatMayBeAnAttackers) {
    for (const char* host :
         {"127.0.0.1:8642", "localhost", "localhost:1", "[::1]:80", "10.0.0.7"}) {
        EXPECT_EQ(status_of(get(port, "/", host)), 200) << host;
    }
    for (const char* host :
         {"evil.example", "evil.example:8642", "localhost.evil.example", "127.0.0.1.evil.example",
          "127.0.0.1:x", "[::1", "", "127.1", "localhost\tx"}) {
        EXPECT_EQ(status_of(get(port, "/", host)), 403) << host;
    }
    const std::string twice = get(port, "/", "localhost", "Host: evil.example\r\n");
    EXPECT_TRUE(status_of(twice) == 403 || status_of(twice) == 400) << twice;
    const std::string none = reply_to(port, "GET / HTTP/1.1\r\nConnection: close\r\n\r\n");
    EXPECT_TRUE(status_of(none) == 403 || status_of(none) == 400) << none;
}

TEST_F(HttpServerTest, NamesAreOfItsTableAndNotOfFiles) {
    for (const char* path : {"/../etc/passwd", "/..%2f..%2fetc/passwd", "//etc/passwd", "/live.js/",
                             "/etc/passwd", "/.", "/live.css"}) {
        EXPECT_EQ(status_of(get(port, path)), 404) << path;
    }
    EXPECT_EQ(status_of(get(port, "/?file=/etc/passwd")), 200) << "no part reads a query";
}

TEST_F(HttpServerTest, AGetHasNoBodyAndABoundedHead) {
    EXPECT_EQ(status_of(get(port, "/", "localhost", "Content-Length: 5\r\n")), 400);
    EXPECT_EQ(status_of(get(port, "/", "localhost", "Transfer-Encoding: chunked\r\n")), 400);
    const int status =
        status_of(get(port, "/", "localhost", "X: " + std::string(100'000, 'x') + "\r\n"));
    EXPECT_TRUE(status == 0 || (status >= 400 && status < 500)) << status;
    EXPECT_EQ(status_of(get(port, "/")), 200);
}

TEST_F(HttpServerTest, AStreamHasEachEventThatItsReaderHasTimeFor) {
    HttpClient client(port);
    client.say("GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n");
    EXPECT_NE(client.take("retry: 1000").find("text/event-stream"), std::string::npos);
    for (int i = 0; i < 20; ++i) {
        const std::string event = "{\"n\":" + std::to_string(i) + "}";
        server->publish(event);
        EXPECT_NE(client.take("data: " + event + "\n\n").find(event), std::string::npos) << i;
    }
}

TEST_F(HttpServerTest, ReadersThatDoNotReadHoldUpNobody) {
    std::vector<HttpClient> slow;
    for (unsigned i = 0; i < kHttpStreamsMax; ++i) {
        slow.emplace_back(port, 4096);
        slow.back().say("GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n");
        ASSERT_NE(slow.back().take("retry").find("200"), std::string::npos) << i;
    }
    const auto begin = Clock::now();
    for (int i = 0; i < 2000; ++i) {
        server->publish(std::string(10'000, 'x'));
    }
    EXPECT_LT(ms_since(begin), 10'000);
    EXPECT_EQ(status_of(get(port, "/")), 200);
    EXPECT_EQ(status_of(get(port, "/events")), 503) << "one reader more than there is room for";
}

TEST_F(HttpServerTest, ConnectionsBeyondTheLimitWaitForNobody) {
    std::vector<HttpClient> idle;
    for (unsigned i = 0; i < 3 * kHttpClientsMax; ++i) {
        idle.emplace_back(port);  // says nothing
    }
    idle.clear();
    int status = 0;
    for (int i = 0; i < 100 && status != 200; ++i) {
        status = status_of(get(port, "/"));
        poll(nullptr, 0, status == 200 ? 0 : 50);
    }
    EXPECT_EQ(status, 200);
}

TEST_F(HttpServerTest, EndsAtOnceWithReadersOnTheLine) {
    std::vector<HttpClient> readers;
    for (int i = 0; i < 5; ++i) {
        readers.emplace_back(port);
        readers.back().say("GET /events HTTP/1.1\r\nHost: localhost\r\n\r\n");
        ASSERT_NE(readers.back().take("retry").find("200"), std::string::npos);
    }
    const auto begin = Clock::now();
    server.reset();
    EXPECT_LT(ms_since(begin), 3000);
    readers.front().take("");
    EXPECT_TRUE(readers.front().is_closed());
}

TEST_F(HttpServerTest, APortInUseIsSaid) {
    std::string fault;
    const auto address = read_listen_address("127.0.0.1:" + std::to_string(port));
    EXPECT_EQ(HttpServer::start(*address, {}, fault), nullptr);
    EXPECT_NE(fault.find("in use"), std::string::npos) << fault;
}

TEST(ListenAddress, IsNumericWithAPort) {
    const auto usual = read_listen_address("127.0.0.1:8642");
    ASSERT_TRUE(usual);
    EXPECT_EQ(usual->host, "127.0.0.1");
    EXPECT_EQ(usual->port, 8642);
    EXPECT_TRUE(usual->is_loopback);
    EXPECT_TRUE(read_listen_address("localhost:80")->is_loopback);
    EXPECT_TRUE(read_listen_address("[::1]:80")->is_loopback);
    EXPECT_FALSE(read_listen_address("0.0.0.0:80")->is_loopback);
    EXPECT_FALSE(read_listen_address("[::]:80")->is_loopback);
    EXPECT_FALSE(read_listen_address("192.168.0.4:80")->is_loopback);
    for (const char* text :
         {"", ":", "127.0.0.1", "127.0.0.1:", "127.0.0.1:65536", "::1:80", "[::1]", "[::1:80",
          "example.org:80", "127.0.0.1:80x", "[127.0.0.1]:80", "1.2.3:80"}) {
        EXPECT_FALSE(read_listen_address(text)) << text;
    }
}

}  // namespace
}  // namespace axg
