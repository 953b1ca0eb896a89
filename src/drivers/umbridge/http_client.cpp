#include "drivers/umbridge/http_client.hpp"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http.hpp>
#include <mutex>
#include <utility>  // which Asio forgets

#include "mottle/core/error.hpp"
#include "mottle/core/text.hpp"

namespace mottle::drivers {
namespace {

namespace asio = boost::asio;
namespace http = boost::beast::http;
using boost::system::error_code;
using Clock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds k_tick{100};           // between looks at the stop request
constexpr std::chrono::milliseconds k_connecting{10'000};  // a host that is not there answers nothing at all

std::string seconds_text(std::chrono::milliseconds time) {
  return fmt::format("{} s", number_text(1e-3 * static_cast<double>(time.count())));
}

/// Asks a silent server's machine from time to time whether it is there: one that is gone is noticed long before the
/// time limit of a request, and routers on the way do not forget the connection.
void keep_alive(asio::ip::tcp::socket& socket) {
  constexpr int k_idle_s = 60;
  constexpr int k_interval_s = 20;
  error_code ignored;
  socket.set_option(asio::socket_base::keep_alive(true), ignored);
  ::setsockopt(socket.native_handle(), IPPROTO_TCP, TCP_KEEPIDLE, &k_idle_s, sizeof(k_idle_s));
  ::setsockopt(socket.native_handle(), IPPROTO_TCP, TCP_KEEPINTVL, &k_interval_s, sizeof(k_interval_s));
}

}  // namespace

class KnownHost {
 public:
  using Endpoints = asio::ip::tcp::resolver::results_type;
  Endpoints get() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return endpoints_;
  }
  void set(const Endpoints& endpoints) {
    const std::lock_guard<std::mutex> lock(mutex_);
    endpoints_ = endpoints;
  }

 private:
  std::mutex mutex_;
  Endpoints endpoints_;
};

std::shared_ptr<KnownHost> make_known_host() {
  return std::make_shared<KnownHost>();
}

/// The socket. Every operation is begun without waiting and then waited for, since a wait can be cut short: all but the
/// look-up of a name, which the system's resolver ends when it likes.
class HttpConnection::Stream {
 public:
  bool is_open() { return stream_.socket().is_open(); }
  /// Closes an idle connection on which something came: it belongs to no request.
  void close_if_unread() {
    error_code error;
    if (is_open() && (stream_.socket().available(error) > 0 || error)) close();
  }
  void close() {
    error_code ignored;
    stream_.socket().close(ignored);
    buffer_.clear();
  }

  /// Empty, or why there is no connection.
  std::string connect(const HttpAddress& address, KnownHost& host, Clock::time_point end,
                      const std::atomic<bool>* stop);
  HttpReply exchange(const http::request<http::string_body>& request, Clock::time_point end,
                     const std::atomic<bool>* stop);

  /// Whether the last exchange ended before a byte of an answer came.
  bool is_unanswered() const { return is_unanswered_; }

 private:
  using Parser = http::response_parser<http::string_body>;
  error_code read_answer(std::optional<Parser>& parser, Clock::time_point end, const std::atomic<bool>* stop);

  /// Waits for what `begin` begins; its handler takes the error and may take more. Past `end` it is cancelled.
  template <typename Begin>
  error_code wait_for(const Begin& begin, Clock::time_point end, const std::atomic<bool>* stop) {
    std::optional<error_code> ended;
    begin([&ended](const error_code& error, const auto&...) { ended = error; });
    context_.restart();
    bool is_late = false;
    while (!ended) {
      const bool is_stopped = stop != nullptr && stop->load(std::memory_order_relaxed);
      context_.poll();  // what came while this process was stopped is there in time
      if (ended) break;
      is_late = Clock::now() >= end;
      if (is_stopped || is_late) {
        resolver_.cancel();
        close();
        context_.run();  // the handler is called with an error now
        if (is_stopped) throw Stopped("stopped on request");
        break;
      }
      context_.run_until(std::min(end, Clock::now() + k_tick));
    }
    return is_late ? error_code(asio::error::timed_out) : *ended;
  }

  asio::io_context context_{1};
  asio::ip::tcp::resolver resolver_{context_};
  boost::beast::tcp_stream stream_{context_};
  boost::beast::flat_buffer buffer_;
  bool is_unanswered_ = false;
};

std::string HttpConnection::Stream::connect(const HttpAddress& address, KnownHost& host, Clock::time_point end,
                                            const std::atomic<bool>* stop) {
  KnownHost::Endpoints found = host.get();
  error_code error;
  if (found.empty()) {
    error = wait_for(
        [&](auto handler) {
          resolver_.async_resolve(address.host, address.port, asio::ip::tcp::resolver::numeric_service,
                                  [handler, &found](const error_code& failure, const auto& results) mutable {
                                    found = results;
                                    handler(failure);
                                  });
        },
        end, stop);
  }
  if (error) return fmt::format("the host '{}' is not found: {}", address.host, error.message());
  error = wait_for([&](auto handler) { stream_.async_connect(found, handler); }, end, stop);
  if (!error) {
    stream_.socket().set_option(asio::ip::tcp::no_delay(true), error);  // else small requests wait for each other
    keep_alive(stream_.socket());
    host.set(found);
    return {};
  }
  host.set({});  // it may have moved
  close();
  return error == asio::error::timed_out ? "no connection: nothing answers there"
                                         : fmt::format("no connection: {}", error.message());
}

error_code HttpConnection::Stream::read_answer(std::optional<Parser>& parser, Clock::time_point end,
                                               const std::atomic<bool>* stop) {
  constexpr unsigned k_interim = 1;  // 100 Continue, 102 Processing, 103 Early Hints: the answer is still to come
  do {
    parser.emplace();
    parser->body_limit(k_largest_answer);
    // The head by itself: where the body comes with it, Beast 1.74 forgets that the head promised too long a one.
    const error_code error =
        wait_for([&](auto handler) { http::async_read_header(stream_, buffer_, *parser, handler); }, end, stop);
    is_unanswered_ = is_unanswered_ && error && error != asio::error::timed_out && !parser->got_some();
    if (error) return error;
  } while (parser->get().result_int() / 100 == k_interim);
  if (parser->is_done()) return {};
  return wait_for([&](auto handler) { http::async_read(stream_, buffer_, *parser, handler); }, end, stop);
}

HttpReply HttpConnection::Stream::exchange(const http::request<http::string_body>& request, Clock::time_point end,
                                           const std::atomic<bool>* stop) {
  std::optional<Parser> parser;
  is_unanswered_ = true;
  error_code error = wait_for([&](auto handler) { http::async_write(stream_, request, handler); }, end, stop);
  if (!error) {
    error = read_answer(parser, end, stop);
  } else if (error == asio::error::timed_out) {
    is_unanswered_ = false;
  }
  // What comes behind an answer would be taken for the next one.
  if (error || !parser->keep_alive() || buffer_.size() > 0) close();
  if (error == http::error::body_limit) {
    return {.failure = fmt::format("the answer is longer than {} MiB", k_largest_answer >> 20)};
  }
  if (error == asio::error::timed_out) return {.failure = "no answer"};
  if (error == http::error::end_of_stream || error == http::error::partial_message || error == asio::error::eof ||
      error == asio::error::connection_reset || error == asio::error::broken_pipe) {
    return {.failure = "the connection ended before the answer did"};
  }
  if (error) return {.failure = fmt::format("the answer is not HTTP: {}", error.message())};
  return {.status = static_cast<int>(parser->get().result_int()), .body = std::move(parser->get().body())};
}

HttpConnection::HttpConnection(HttpAddress address, std::shared_ptr<KnownHost> host)
    : address_(std::move(address)), host_(std::move(host)), stream_(std::make_unique<Stream>()) {}

HttpConnection::~HttpConnection() = default;

HttpReply HttpConnection::send(const HttpRequest& request, std::chrono::milliseconds timeout,
                               const std::atomic<bool>* stop) {
  const Clock::time_point end = Clock::now() + timeout;
  http::request<http::string_body> message(request.body ? http::verb::post : http::verb::get,
                                           address_.path + request.path, 11);
  message.set(http::field::host, address_.authority());
  message.set(http::field::user_agent, "mottle");
  message.set(http::field::accept, "*/*");
  if (request.body) {
    message.set(http::field::content_type, "application/json");
    message.body() = *request.body;
  }
  message.prepare_payload();
  HttpReply reply;
  stream_->close_if_unread();
  const bool was_open = stream_->is_open();
  if (was_open) reply = stream_->exchange(message, end, stop);
  if (!was_open || stream_->is_unanswered()) {
    reply = {.failure = stream_->connect(address_, *host_, std::min(end, Clock::now() + k_connecting), stop)};
    if (reply.failure.empty()) reply = stream_->exchange(message, end, stop);
  }
  if (reply.failure == "no answer") reply.failure = fmt::format("no answer within {}", seconds_text(timeout));
  return reply;
}

}  // namespace mottle::drivers
