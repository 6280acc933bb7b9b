// SPDX-License-Identifier: Apache-2.0
#include "hil_replay/watch/http_server.hpp"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <microhttpd.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <mutex>
#include <set>
#include <utility>

namespace axg {
namespace {

constexpr const char* kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; "
    "img-src 'self' data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
constexpr std::size_t kStreamBlockBytes = 4096;

void add_headers(MHD_Response* response, const char* type) {
    constexpr std::pair<const char*, const char*> kHeaders[]{
        {"Content-Security-Policy", kPolicy},
        {"X-Content-Type-Options", "nosniff"},
        {"Referrer-Policy", "no-referrer"},
        {"Cross-Origin-Resource-Policy", "same-origin"},
        {"Cross-Origin-Opener-Policy", "same-origin"},
        {"Cache-Control", "no-store"}};
    for (const auto& [name, value] : kHeaders) {
        MHD_add_response_header(response, name, value);
    }
    MHD_add_response_header(response, "Content-Type", type);
}

MHD_Result answer(MHD_Connection* connection, unsigned status, MHD_Response* response) {
    if (response == nullptr) {
        return MHD_NO;
    }
    const MHD_Result result = MHD_queue_response(connection, status, response);
    MHD_destroy_response(response);
    return result;
}

/// @param lives  whether the text outlives the connection; else it is copied
MHD_Response* make_response(std::string_view text, const char* type, bool lives) {
    MHD_Response* const response = MHD_create_response_from_buffer(
        text.size(), const_cast<char*>(text.data()),  // NOLINT: read alone, says the manual
        lives ? MHD_RESPMEM_PERSISTENT : MHD_RESPMEM_MUST_COPY);
    if (response != nullptr) {
        add_headers(response, type);
    }
    return response;
}

MHD_Result refuse(MHD_Connection* connection, unsigned status, std::string_view words) {
    MHD_Response* const response = make_response(words, "text/plain; charset=utf-8", true);
    if (response != nullptr && status == MHD_HTTP_METHOD_NOT_ALLOWED) {
        MHD_add_response_header(response, "Allow", "GET");
    }
    return answer(connection, status, response);
}

/// The one value of a header; nothing: it is not there, or more than once.
std::optional<std::string_view> header_of(MHD_Connection* connection, const char* name) {
    struct Found {
        const char* name;
        const char* value = nullptr;
        unsigned count = 0;
    } found{name};
    MHD_get_connection_values(
        connection, MHD_HEADER_KIND,
        [](void* to, MHD_ValueKind, const char* key, const char* value) {
            Found& out = *static_cast<Found*>(to);
            if (strcasecmp(key, out.name) == 0) {
                out.value = value;
                ++out.count;
            }
            return MHD_YES;
        },
        &found);
    if (found.count != 1 || found.value == nullptr) {
        return std::nullopt;
    }
    return found.value;
}

bool has_body(MHD_Connection* connection) {
    const char* const length =
        MHD_lookup_connection_value(connection, MHD_HEADER_KIND, "Content-Length");
    return (length != nullptr && std::strcmp(length, "0") != 0) ||
           MHD_lookup_connection_value(connection, MHD_HEADER_KIND, "Transfer-Encoding") != nullptr;
}

std::string words(const ListenAddress& address, int error) {
    const std::string place = fmt::format("{}{}{}:{}", address.is_ipv6 ? "[" : "", address.host,
                                          address.is_ipv6 ? "]" : "", address.port);
    return error == EADDRINUSE
               ? fmt::format(
                     "--listen: {} is in use. End the program that listens there, or pass "
                     "another port.",
                     place)
               : fmt::format("--listen: {}: {}. Pass an address of this computer.", place,
                             std::strerror(error));
}

/// A socket that listens; -1: the reason is in errno.
int listen_at(const ListenAddress& address) {
    const int made =
        socket(address.is_ipv6 ? AF_INET6 : AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
    if (made < 0) {
        return -1;
    }
    const int on = 1;
    setsockopt(made, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    int result = -1;
    if (address.is_ipv6) {
        sockaddr_in6 at{};
        at.sin6_family = AF_INET6;
        at.sin6_port = htons(address.port);
        inet_pton(AF_INET6, address.host.c_str(), &at.sin6_addr);
        result = bind(made, reinterpret_cast<const sockaddr*>(&at), sizeof at);
    } else {
        sockaddr_in at{};
        at.sin_family = AF_INET;
        at.sin_port = htons(address.port);
        inet_pton(AF_INET, address.host.c_str(), &at.sin_addr);
        result = bind(made, reinterpret_cast<const sockaddr*>(&at), sizeof at);
    }
    if (result != 0 || listen(made, kHttpClientsMax) != 0) {
        const int error = errno;
        close(made);
        errno = error;
        return -1;
    }
    return made;
}

std::uint16_t port_of(int socket) {
    sockaddr_in6 at{};
    socklen_t size = sizeof at;
    if (getsockname(socket, reinterpret_cast<sockaddr*>(&at), &size) != 0) {
        return 0;
    }
    return ntohs(at.sin6_port);  // at the same place as of IPv4
}

}  // namespace

struct HttpServer::Impl {
    /// One client that reads events.
    struct Stream {
        Impl* server = nullptr;
        MHD_Connection* connection = nullptr;
        std::string text = "retry: 1000\n\n";  // that it is being sent
        std::size_t sent = 0;
        std::uint64_t number = 0;  // of the event in the text
    };

    static MHD_Result on_request(void* self, MHD_Connection* connection, const char* path,
                                 const char* method, const char* version, const char* upload,
                                 std::size_t* upload_bytes, void** request);
    static ssize_t on_read(void* from, std::uint64_t position, char* to, std::size_t size);
    static void on_closed(void* from);
    MHD_Result open_stream(MHD_Connection* connection);
    void wake_all();

    HttpParts parts;
    MHD_Daemon* daemon = nullptr;
    std::uint16_t port = 0;
    std::mutex mutex;  // of all below; held for copies of a text alone
    std::string event;
    std::uint64_t number = 0;  // of the event; 0: there is none
    std::set<Stream*> waiting;
    unsigned streams = 0;
    bool is_ending = false;
};

MHD_Result HttpServer::Impl::on_request(void* self, MHD_Connection* connection, const char* path,
                                        const char* method, const char* /*version*/,
                                        const char* /*upload*/, std::size_t* /*upload_bytes*/,
                                        void** /*request*/) {
    Impl& server = *static_cast<Impl*>(self);
    if (std::strcmp(method, "GET") != 0) {
        return refuse(connection, MHD_HTTP_METHOD_NOT_ALLOWED, "GET only\n");
    }
    const std::optional<std::string_view> host = header_of(connection, "Host");
    if (!host || !is_host_allowed(*host)) {
        return refuse(connection, MHD_HTTP_FORBIDDEN,
                      "Host: expected localhost or a numeric address\n");
    }
    if (has_body(connection)) {
        return refuse(connection, MHD_HTTP_BAD_REQUEST, "a GET has no body\n");
    }
    const std::string_view name = path;
    if (name == "/events") {
        return server.open_stream(connection);
    }
    if (name == "/state") {
        std::string text;
        {
            const std::lock_guard lock(server.mutex);
            text = server.event;
        }
        if (text.empty()) {
            return refuse(connection, MHD_HTTP_SERVICE_UNAVAILABLE, "no event yet\n");
        }
        return answer(connection, MHD_HTTP_OK, make_response(text, "application/json", false));
    }
    const auto part = server.parts.find(name);
    if (part == server.parts.end()) {
        return refuse(connection, MHD_HTTP_NOT_FOUND, "not found\n");
    }
    return answer(connection, MHD_HTTP_OK,
                  make_response(part->second.body, part->second.type.c_str(), true));
}

MHD_Result HttpServer::Impl::open_stream(MHD_Connection* connection) {
    {
        const std::lock_guard lock(mutex);
        if (streams >= kHttpStreamsMax || is_ending) {
            return refuse(connection, MHD_HTTP_SERVICE_UNAVAILABLE, "too many readers\n");
        }
        ++streams;
    }
    auto stream = std::make_unique<Stream>();
    stream->server = this;
    stream->connection = connection;
    MHD_Response* const response = MHD_create_response_from_callback(
        MHD_SIZE_UNKNOWN, kStreamBlockBytes, &on_read, stream.get(), &on_closed);
    if (response == nullptr) {
        const std::lock_guard lock(mutex);
        --streams;
        return MHD_NO;
    }
    add_headers(response, "text/event-stream");
    static_cast<void>(stream.release());  // on_closed() ends it
    return answer(connection, MHD_HTTP_OK, response);
}

/// The library's thread calls this when the connection can send more.
ssize_t HttpServer::Impl::on_read(void* from, std::uint64_t /*position*/, char* to,
                                  std::size_t size) {
    Stream& stream = *static_cast<Stream*>(from);
    Impl& server = *stream.server;
    const std::lock_guard lock(server.mutex);
    if (server.is_ending) {
        return MHD_CONTENT_READER_END_OF_STREAM;
    }
    if (stream.sent == stream.text.size()) {
        if (stream.number == server.number) {
            server.waiting.insert(&stream);
            MHD_suspend_connection(stream.connection);
            return 0;
        }
        stream.number = server.number;
        stream.text = "data: " + server.event + "\n\n";
        stream.sent = 0;
    }
    const std::size_t count = std::min(size, stream.text.size() - stream.sent);
    std::copy_n(stream.text.data() + stream.sent, count, to);
    stream.sent += count;
    return static_cast<ssize_t>(count);
}

void HttpServer::Impl::on_closed(void* from) {
    const std::unique_ptr<Stream> stream(static_cast<Stream*>(from));
    Impl& server = *stream->server;
    const std::lock_guard lock(server.mutex);
    server.waiting.erase(stream.get());
    --server.streams;
}

/// With the mutex held.
void HttpServer::Impl::wake_all() {
    for (Stream* const stream : waiting) {
        MHD_resume_connection(stream->connection);
    }
    waiting.clear();
}

HttpServer::HttpServer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

HttpServer::~HttpServer() {
    {
        const std::lock_guard lock(impl_->mutex);
        impl_->is_ending = true;
        impl_->wake_all();
    }
    MHD_stop_daemon(impl_->daemon);
}

bool HttpServer::is_built() noexcept {
    return true;
}

std::unique_ptr<HttpServer> HttpServer::start(const ListenAddress& address, HttpParts parts,
                                              std::string& fault) {
    const int socket = listen_at(address);
    if (socket < 0) {
        fault = words(address, errno);
        return nullptr;
    }
    auto impl = std::make_unique<Impl>();
    impl->parts = std::move(parts);
    impl->port = port_of(socket);
    impl->daemon = MHD_start_daemon(
        MHD_USE_AUTO | MHD_USE_INTERNAL_POLLING_THREAD | MHD_ALLOW_SUSPEND_RESUME, 0, nullptr,
        nullptr, &Impl::on_request, impl.get(), MHD_OPTION_LISTEN_SOCKET, socket,
        MHD_OPTION_CONNECTION_LIMIT, kHttpClientsMax, MHD_OPTION_CONNECTION_TIMEOUT,
        kHttpIdleSecondsMax, MHD_OPTION_CONNECTION_MEMORY_LIMIT, kHttpRequestBytesMax,
        MHD_OPTION_STRICT_FOR_CLIENT, 1, MHD_OPTION_END);
    if (impl->daemon == nullptr) {
        fault = words(address, errno);
        close(socket);
        return nullptr;
    }
    return std::unique_ptr<HttpServer>(new HttpServer(std::move(impl)));
}

void HttpServer::publish(std::string event) {
    const std::lock_guard lock(impl_->mutex);
    impl_->event = std::move(event);
    ++impl_->number;
    impl_->wake_all();
}

std::uint16_t HttpServer::port() const noexcept {
    return impl_->port;
}

}  // namespace axg
