#pragma once

#include <asio.hpp>
#include <asio/ssl.hpp>
#include <memory>
#include <utility>
#include <variant>

namespace cycloid::transport {

/// The bytes of one connection, over TCP alone or through TLS: who reads and writes does not know
/// which. An AsyncReadStream and AsyncWriteStream, so `asio::async_write` takes it.
///
/// All operations take any completion token, and of each kind one may be under way. They run where
/// the caller's executor says, all on one strand.
class Stream {
 public:
  using Socket = asio::ip::tcp::socket;
  using Tls = asio::ssl::stream<Socket>;
  using Context = std::shared_ptr<asio::ssl::context>;
  using executor_type = Socket::executor_type;
  using lowest_layer_type = Socket::lowest_layer_type;

  /// @param context  Through TLS as it says; null: TCP alone.
  explicit Stream(Socket socket, Context context = nullptr)
      : context_(std::move(context)), layer_(make_layer(std::move(socket), context_)) {}
  /// Not connected yet; `socket` is what to connect.
  explicit Stream(executor_type executor, Context context = nullptr)
      : context_(std::move(context)), layer_(make_layer(std::move(executor), context_)) {}

  bool is_tls() const { return std::holds_alternative<Tls>(layer_); }
  /// Null over TCP alone.
  Tls* tls() { return std::get_if<Tls>(&layer_); }
  Socket& socket() { return is_tls() ? tls()->next_layer() : std::get<Socket>(layer_); }
  const Socket& socket() const {
    const auto* tls = std::get_if<Tls>(&layer_);
    return tls != nullptr ? tls->next_layer() : std::get<Socket>(layer_);
  }
  bool is_open() const { return socket().is_open(); }
  executor_type get_executor() { return socket().get_executor(); }
  lowest_layer_type& lowest_layer() { return socket().lowest_layer(); }

  /// Before the first byte of a stream through TLS. Without a deadline of its own.
  /// @pre is_tls()
  template <class Token>
  auto async_handshake(asio::ssl::stream_base::handshake_type type, Token&& token) {
    return tls()->async_handshake(type, std::forward<Token>(token));
  }

  template <class Buffers, class Token>
  auto async_read_some(const Buffers& buffers, Token&& token) {
    if (Tls* through = tls()) return through->async_read_some(buffers, std::forward<Token>(token));
    return std::get<Socket>(layer_).async_read_some(buffers, std::forward<Token>(token));
  }

  template <class Buffers, class Token>
  auto async_write_some(const Buffers& buffers, Token&& token) {
    if (Tls* through = tls()) return through->async_write_some(buffers, std::forward<Token>(token));
    return std::get<Socket>(layer_).async_write_some(buffers, std::forward<Token>(token));
  }

  /// Says that nothing more will be written; what the peer says is read on. Through TLS it ends
  /// when the peer has said the same, which may be never: the caller bounds it by closing.
  /// @pre no write is under way
  template <class Token>
  auto async_shutdown(Token&& token) {
    if (Tls* through = tls()) return through->async_shutdown(std::forward<Token>(token));
    auto initiate = [](auto handler, Stream* self) {
      asio::error_code error;
      self->socket().shutdown(Socket::shutdown_send, error);
      const auto executor = asio::get_associated_executor(handler, self->get_executor());
      asio::post(executor, [handler = std::move(handler), error]() mutable { handler(error); });
    };
    return asio::async_initiate<Token, void(asio::error_code)>(std::move(initiate), token, this);
  }

  /// Without a farewell. Whatever is under way ends with operation_aborted.
  void close() {
    asio::error_code ignored;  // Closed is closed.
    socket().close(ignored);
  }

 private:
  using Layer = std::variant<Socket, Tls>;

  template <class Source>
  static Layer make_layer(Source source, const Context& context) {
    if (context == nullptr) return Layer(std::in_place_type<Socket>, std::move(source));
    return Layer(std::in_place_type<Tls>, std::move(source), *context);
  }

  Context context_;  ///< Outlives the layer that was made of it.
  Layer layer_;
};

/// Whether the peer has hung up, with TLS's farewell or without.
inline bool is_end(const asio::error_code& error) {
  return error == asio::error::eof || error == asio::ssl::error::stream_truncated;
}

}  // namespace cycloid::transport
