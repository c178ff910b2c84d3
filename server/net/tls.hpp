#pragma once

#include <asio.hpp>
#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <string>
#include <vector>

#include "protocol/transport/stream.hpp"

namespace cycloid::server {

/// Both in PEM. The chain begins with the server's own certificate.
struct TlsFiles {
  std::string certificate_chain;
  std::string private_key;
};

/// Names the file and what is wrong with it.
struct TlsFileError : std::runtime_error {
  TlsFileError(bool of_the_key, const std::string& what)
      : std::runtime_error(what), of_key(of_the_key) {}
  bool of_key;  ///< Else of the certificate chain.
};

/// The server's certificate. There is no "if the client likes": whoever sits between the two could
/// then make both like none. TLS 1.2 and later, ciphers with forward secrecy only, no compression,
/// no renegotiation, no resumption. May be used from several threads.
class ServerTls {
 public:
  /// @throws TlsFileError
  explicit ServerTls(TlsFiles files);

  /// Reads the files again: "" and connections from now on get what is in them, or why not, and
  /// nothing has changed. Those that live keep what they have.
  std::string reload();
  /// For a new `transport::Stream`. Never null.
  transport::Stream::Context current() const;
  /// When the certificate in use ends to be valid, in Unix seconds: clients refuse it from then on.
  std::int64_t expires_unix_s() const;
  /// What a client may pin: SHA-256 of the certificate in use, 64 hexadecimal digits.
  std::string fingerprint() const;

 private:
  struct Loaded {
    transport::Stream::Context context;
    std::int64_t expires_unix_s = 0;
    std::string fingerprint;
  };
  static Loaded load(const TlsFiles& files);

  TlsFiles files_;
  mutable std::mutex mutex_;
  Loaded loaded_;
};

struct Handshake {
  enum class End : std::uint8_t {
    kDone,       ///< Through TLS; or the stream is TCP alone, and there was nothing to do.
    kPlaintext,  ///< The client does not speak TLS. It may still be told so, on the socket.
    kOverdue,    ///< Not done in time.
    kFailed,     ///< The client hung up, or there is no common ground.
  };
  End end = End::kDone;
  std::string reason;  ///< For the log, where it is not done.
};

/// Shakes hands as the server. At the deadline the stream is closed, whatever bytes have come.
/// @pre runs on the strand of the stream, which outlives it
asio::awaitable<Handshake> shake_hands(transport::Stream& stream,
                                       std::chrono::steady_clock::time_point deadline);

/// What a client that does not speak TLS is told: an encoded Refused that it understands.
std::vector<std::byte> tls_required_message();

}  // namespace cycloid::server
