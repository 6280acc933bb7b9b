// SPDX-License-Identifier: Apache-2.0
// HttpServer of a build without libmicrohttpd.
#include "hil_replay/watch/http_server.hpp"

namespace axg {

struct HttpServer::Impl {};

HttpServer::HttpServer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
HttpServer::~HttpServer() = default;

bool HttpServer::is_built() noexcept {
    return false;
}

// NOLINTNEXTLINE(performance-unnecessary-value-param): as the real one
std::unique_ptr<HttpServer> HttpServer::start(const ListenAddress& /*address*/, HttpParts /*parts*/,
                                              std::string& fault) {
    fault =
        "this axguard was built without libmicrohttpd. Install it (Debian: libmicrohttpd-dev) "
        "and build again.";
    return nullptr;
}

// NOLINTNEXTLINE(performance-unnecessary-value-param): as the real one
void HttpServer::publish(std::string /*event*/) {}

std::uint16_t HttpServer::port() const noexcept {
    return 0;
}

}  // namespace axg
