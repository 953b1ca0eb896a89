#include "mottle/drivers/umbridge/model_server.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http.hpp>
#include <thread>
#include <utility>  // which Asio forgets

#include "drivers/umbridge/model_requests.hpp"
#include "drivers/umbridge/request_queue.hpp"
#include "mottle/core/error.hpp"

namespace mottle::drivers {
namespace {

namespace asio = boost::asio;
namespace http = boost::beast::http;
using asio::ip::tcp;
using boost::system::error_code;

constexpr std::size_t k_largest_request = std::size_t{4} << 20;
constexpr std::size_t k_max_connections = 512;    // each may hold a request of that size
constexpr std::chrono::seconds k_patience{30};    // with a client that sends or reads slowly
constexpr std::chrono::seconds k_idle{300};       // between two requests of one client
constexpr std::chrono::milliseconds k_tick{100};  // between looks at the stop request

}  // namespace

/// One thread speaks with all clients, one computes: models need not bear several threads, and a long computation keeps
/// nobody from asking what is offered.
class ModelServer::Implementation {
 public:
  Implementation(ServedModel model, int port);
  std::uint16_t port() const { return acceptor_.local_endpoint().port(); }
  void serve(const RunContext& context);

  const ServedModel& model() const { return model_; }
  void enter() { ++connections_; }
  void leave();
  void compute(WaitingRequest waiting);

 private:
  void accept();
  void look_for_stop(const RunContext& context);

  ServedModel model_;
  std::size_t connections_ = 0;  // which sessions count down that end with the context
  asio::io_context context_{1};
  tcp::acceptor acceptor_{context_};
  asio::steady_timer timer_{context_};
  bool is_accepting_ = false;
  RequestQueue queue_;
};

/// A client: reads requests and writes answers, one at a time, for as long as both sides like.
class ClientSession : public std::enable_shared_from_this<ClientSession> {
 public:
  ClientSession(tcp::socket socket, ModelServer::Implementation& server) : stream_(std::move(socket)), server_(server) {
    server_.enter();
  }
  ~ClientSession() { server_.leave(); }
  ClientSession(const ClientSession&) = delete;
  ClientSession& operator=(const ClientSession&) = delete;

  void read_next(std::chrono::seconds patience) {
    parser_.emplace();
    parser_->body_limit(k_largest_request);
    stream_.expires_after(patience);
    http::async_read_header(stream_, buffer_, *parser_, [self = shared_from_this()](error_code error, std::size_t) {
      if (error) return self->refuse(error);
      self->read_body();
    });
  }

 private:
  void read_body() {
    stream_.expires_after(k_patience);
    http::async_read(stream_, buffer_, *parser_, [self = shared_from_this()](error_code error, std::size_t) {
      if (error) return self->refuse(error);
      self->handle();
    });
  }

  void handle() {
    is_head_ = parser_->get().method() == http::verb::head;
    const http::request<http::string_body>& request = parser_->get();
    is_kept_ = request.keep_alive();
    // A page in a browser may post anywhere; it names its origin.
    if (request.count(http::field::origin) > 0) {
      return write(error_answer(403, "InvalidInput", "requests of web pages are not answered"));
    }
    const bool is_post = request.method() == http::verb::post;
    const bool is_get = request.method() == http::verb::get || request.method() == http::verb::head;
    if (!is_post && !is_get) return write(error_answer(405, "InvalidInput", "only GET and POST are answered"));
    const std::string target(request.target());
    ReadRequest read = read_request(server_.model(), is_post, target.substr(0, target.find('?')), request.body());
    if (read.answer) return write(*std::move(read.answer));
    stream_.expires_never();
    server_.compute({std::move(read.computation),
                     [self = shared_from_this()](ServerAnswer answer) { self->write(std::move(answer)); }});
  }

  /// What is too large or no HTTP is told where that is possible.
  void refuse(error_code error) {
    is_kept_ = false;
    if (error == http::error::header_limit) {
      write(error_answer(413, "InvalidInput", "the head of a request has at most 8 KiB"));
    } else if (error == http::error::body_limit) {
      write(error_answer(413, "InvalidInput", fmt::format("a request has at most {} MiB", k_largest_request >> 20)));
    } else if (error.category() == http::make_error_code(http::error::bad_method).category() &&
               error != http::error::end_of_stream && error != http::error::partial_message) {
      write(error_answer(400, "InvalidInput", "the request is not HTTP"));
    }
  }

  void write(ServerAnswer answer) {
    parser_.reset();  // an idle client is to hold no request
    const bool is_head = is_head_;
    response_ = {static_cast<http::status>(answer.status), 11};
    response_.set(http::field::server, "mottle");
    response_.set(http::field::content_type, "application/json");
    response_.keep_alive(is_kept_);
    const std::size_t size = answer.body.size();
    if (!is_head) response_.body() = std::move(answer.body);
    response_.content_length(size);
    serializer_.emplace(response_);
    serializer_->split(is_head);
    stream_.expires_after(k_patience);
    const auto done = [self = shared_from_this()](error_code error, std::size_t) {
      if (error) return;
      if (self->is_kept_) return self->read_next(k_idle);
      error_code ignored;
      self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
      self->drain(0);
    };
    if (is_head) {
      http::async_write_header(stream_, *serializer_, done);
    } else {
      http::async_write(stream_, *serializer_, done);
    }
  }

  /// Takes what the client still sends, within limits: a connection that is closed on unread bytes is reset, and the
  /// client may lose the answer with it.
  void drain(std::size_t taken) {
    constexpr std::size_t k_max_drained = std::size_t{64} << 20;
    constexpr std::size_t k_piece = 65536;
    constexpr std::chrono::seconds k_longest_wait{5};
    if (taken >= k_max_drained) return;
    buffer_.clear();
    stream_.expires_after(k_longest_wait);
    stream_.async_read_some(buffer_.prepare(k_piece),
                            [self = shared_from_this(), taken](error_code error, std::size_t size) {
                              if (!error) self->drain(taken + size);
                            });
  }

  boost::beast::tcp_stream stream_;
  ModelServer::Implementation& server_;
  boost::beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::string_body>> parser_;
  http::response<http::string_body> response_;
  std::optional<http::response_serializer<http::string_body>> serializer_;
  bool is_kept_ = false;
  bool is_head_ = false;
};

ModelServer::Implementation::Implementation(ServedModel model, int port) : model_(std::move(model)), queue_(model_) {
  const tcp::endpoint here(asio::ip::address_v4::loopback(), static_cast<std::uint16_t>(port));
  error_code error;
  acceptor_.open(tcp::v4(), error);
  if (error) throw SystemFailure(fmt::format("no socket can be had: {}", error.message()));
  acceptor_.set_option(asio::socket_base::reuse_address(true), error);
  acceptor_.bind(here, error);
  if (!error) acceptor_.listen(asio::socket_base::max_listen_connections, error);
  require(!error, "port {} of 127.0.0.1 cannot be had: {}; choose another, or 0 for one that is free", port,
          error.message());
}

void ModelServer::Implementation::accept() {
  if (is_accepting_ || connections_ >= k_max_connections) return;
  is_accepting_ = true;
  acceptor_.async_accept([this](error_code error, tcp::socket socket) {
    is_accepting_ = false;
    if (error == asio::error::operation_aborted) return;
    if (!error) {
      error_code ignored;
      socket.set_option(tcp::no_delay(true), ignored);
      std::make_shared<ClientSession>(std::move(socket), *this)->read_next(k_patience);
    }
    if (!error) accept();  // else at the next tick: there may be no descriptor left
  });
}

void ModelServer::Implementation::leave() {
  --connections_;
}

void ModelServer::Implementation::look_for_stop(const RunContext& context) {
  timer_.expires_after(k_tick);
  timer_.async_wait([this, &context](error_code) {
    if (context.stop_requested() || queue_.has_failed()) return context_.stop();
    accept();
    look_for_stop(context);
  });
}

/// The answer is written by the thread that speaks with the clients, and there alone their sessions end.
void ModelServer::Implementation::compute(WaitingRequest waiting) {
  queue_.add({std::move(waiting.computation), [this, reply = std::move(waiting.reply)](ServerAnswer answer) mutable {
                asio::post(context_, [reply = std::move(reply), answer = std::move(answer)]() mutable {
                  reply(std::move(answer));
                });
              }});
}

void ModelServer::Implementation::serve(const RunContext& context) {
  std::thread worker([this] { queue_.compute_all(); });
  std::exception_ptr failure;
  try {
    accept();
    look_for_stop(context);
    context_.run();
  } catch (...) {
    failure = std::current_exception();
  }
  queue_.end();
  worker.join();
  if (failure) std::rethrow_exception(failure);
  if (!context.stop_requested()) queue_.rethrow();
}

ModelServer::ModelServer(ServedModel model, int port)
    : implementation_(std::make_unique<Implementation>(std::move(model), port)) {}

ModelServer::~ModelServer() = default;

std::string ModelServer::address() const {
  return fmt::format("http://127.0.0.1:{}", implementation_->port());
}

void ModelServer::serve(const RunContext& context) {
  implementation_->serve(context);
}

}  // namespace mottle::drivers
