#include "server/net/tls.hpp"

#include <openssl/pem.h>
#include <openssl/ssl.h>
#include <openssl/x509.h>

#include <array>
#include <ctime>
#include <utility>

#include "protocol/codec.hpp"
#include "protocol/transport/fingerprint.hpp"
#include "server/operation/text_file.hpp"

namespace cycloid::server {
namespace {

// GCC 12.2 destroys aggregate temporaries of a co_await expression twice: named locals only.

using transport::Stream;

/// TLS 1.3 has no others than these of its own; of TLS 1.2 those with forward secrecy and AEAD.
constexpr const char* kCiphersOfTls12 = "ECDHE+AESGCM:ECDHE+CHACHA20";
/// The first byte of every TLS connection: a record of the handshake. A hello of this protocol that
/// begins so has 22, 278, 534 or 790 bytes; TLS itself then finds that it is none.
constexpr unsigned char kHandshakeRecord = 0x16;
constexpr const char* kTlsRequired = "this server speaks TLS only";

[[noreturn]] void fail_of_chain(const TlsFiles& files, const std::string& why) {
  throw TlsFileError(false, files.certificate_chain + ": " + why);
}

[[noreturn]] void fail_of_key(const TlsFiles& files, const std::string& why) {
  throw TlsFileError(true, files.private_key + ": " + why);
}

std::int64_t expiry_of(SSL_CTX* context) {
  std::tm end{};
  const X509* certificate = SSL_CTX_get0_certificate(context);
  if (ASN1_TIME_to_tm(X509_get0_notAfter(certificate), &end) != 1) return 0;
  return static_cast<std::int64_t>(timegm(&end));
}

void harden(asio::ssl::context& context) {
  SSL_CTX* const handle = context.native_handle();
  SSL_CTX_set_min_proto_version(handle, TLS1_2_VERSION);
  SSL_CTX_set_cipher_list(handle, kCiphersOfTls12);
  SSL_CTX_set_options(handle, SSL_OP_NO_COMPRESSION | SSL_OP_NO_RENEGOTIATION | SSL_OP_NO_TICKET |
                                  SSL_OP_CIPHER_SERVER_PREFERENCE);
  SSL_CTX_set_num_tickets(handle, 0);
  SSL_CTX_set_session_cache_mode(handle, SSL_SESS_CACHE_OFF);
  // 34 KiB less for each connection that waits.
  SSL_CTX_set_mode(handle, SSL_MODE_RELEASE_BUFFERS);
}

/// Whether the first byte says that this is no TLS; waits for it.
asio::awaitable<bool> begins_in_plaintext(Stream& stream, asio::error_code& error) {
  auto done = asio::redirect_error(asio::use_awaitable, error);
  co_await stream.socket().async_wait(asio::ip::tcp::socket::wait_read, done);
  if (error) co_return false;
  stream.socket().non_blocking(true, error);  // Readiness may be false; nothing may block here.
  if (error) co_return false;
  std::array<unsigned char, 1> first{};
  const auto target = asio::buffer(first);
  const std::size_t bytes =
      stream.socket().receive(target, asio::ip::tcp::socket::message_peek, error);
  if (error == asio::error::would_block) error.clear();
  co_return !error && bytes == 1 && first[0] != kHandshakeRecord;
}

}  // namespace

ServerTls::ServerTls(TlsFiles files) : files_(std::move(files)), loaded_(load(files_)) {}

ServerTls::Loaded ServerTls::load(const TlsFiles& files) {
  const auto chain = read_text_file(files.certificate_chain);
  if (!chain || chain->empty()) fail_of_chain(files, "cannot be read");
  const auto key = read_text_file(files.private_key);
  if (!key || key->empty()) fail_of_key(files, "cannot be read");
  auto context = std::make_shared<asio::ssl::context>(asio::ssl::context::tls_server);
  harden(*context);
  asio::error_code error;
  // A key behind a password would ask for it at the terminal, where nobody sits.
  context->set_password_callback([](std::size_t, auto) { return std::string(); }, error);
  context->use_certificate_chain(asio::buffer(*chain), error);
  if (error) fail_of_chain(files, "is no certificate chain in PEM: " + error.message());
  context->use_private_key(asio::buffer(*key), asio::ssl::context::pem, error);
  if (error) {
    fail_of_key(files, "is no private key in PEM, without a password, of the certificate in " +
                           files.certificate_chain + ": " + error.message());
  }
  if (SSL_CTX_check_private_key(context->native_handle()) != 1)
    fail_of_key(files, "is not the key of the certificate in " + files.certificate_chain);
  SSL_CTX* const handle = context->native_handle();
  const auto fingerprint = transport::fingerprint_of(SSL_CTX_get0_certificate(handle));
  return {context, expiry_of(handle), transport::fingerprint_text(fingerprint)};
}

std::string ServerTls::reload() {
  try {
    Loaded fresh = load(files_);
    const std::lock_guard lock(mutex_);
    loaded_ = std::move(fresh);
    return "";
  } catch (const std::runtime_error& error) {
    return error.what();
  }
}

Stream::Context ServerTls::current() const {
  const std::lock_guard lock(mutex_);
  return loaded_.context;
}

std::int64_t ServerTls::expires_unix_s() const {
  const std::lock_guard lock(mutex_);
  return loaded_.expires_unix_s;
}

std::string ServerTls::fingerprint() const {
  const std::lock_guard lock(mutex_);
  return loaded_.fingerprint;
}

/// Shared with the timer's handler, which may run after the coroutine and the stream have gone. Not
/// within the coroutine: GCC 12 takes such a class for one of its file alone, which a frame, known
/// to others, may not have in it.
struct HandshakeWatch {
  bool done = false;
  bool overdue = false;
};

asio::awaitable<Handshake> shake_hands(Stream& stream,
                                       std::chrono::steady_clock::time_point deadline) {
  Handshake shaken;
  if (!stream.is_tls()) co_return shaken;
  const auto executor = co_await asio::this_coro::executor;
  asio::steady_timer timer(executor, deadline);
  const auto watch = std::make_shared<HandshakeWatch>();
  timer.async_wait([watch, &stream](const asio::error_code& error) {
    if (error || watch->done) return;
    watch->overdue = true;
    stream.close();
  });
  asio::error_code error;
  const bool plain = co_await begins_in_plaintext(stream, error);
  if (!error && !plain) {
    auto done = asio::redirect_error(asio::use_awaitable, error);
    co_await stream.async_handshake(asio::ssl::stream_base::server, done);
  }
  watch->done = true;
  timer.cancel();
  if (watch->overdue) {
    shaken = {Handshake::End::kOverdue, "no TLS handshake in time"};
  } else if (plain) {
    shaken = {Handshake::End::kPlaintext, kTlsRequired};
  } else if (error) {
    shaken = {Handshake::End::kFailed, "no TLS handshake: " + error.message()};
  }
  co_return shaken;
}

std::vector<std::byte> tls_required_message() {
  const protocol::Refused refused{protocol::Refusal::kBadMessage, kTlsRequired};
  return protocol::encode(protocol::ServerMessage(refused));
}

}  // namespace cycloid::server
