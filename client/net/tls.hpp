#pragma once

#include <asio.hpp>
#include <memory>
#include <string>

#include "protocol/transport/stream.hpp"

namespace cycloid::client {

/// Whom the client believes to be the server.
struct TlsTrust {
  /// Certificates in PEM that may have signed the server's; "": those of the system. The name that
  /// was connected to has to be in the server's certificate, which has to be in its time.
  std::string ca_file;
  /// If not "": the SHA-256 of the server's certificate. Then it is that one or none, whoever has
  /// signed it, whatever name and time are in it.
  std::string fingerprint;
};

/// How a client makes connections through TLS, 1.2 or later. The peer is always verified.
class ClientTls {
 public:
  /// @throws std::runtime_error that names the field or file and what is wrong with it.
  explicit ClientTls(const TlsTrust& trust);

  /// For a new `transport::Stream`. Never null.
  transport::Stream::Context context() const { return context_; }
  /// Before the handshake: says and checks the name.
  /// @param host  As it was connected to: a name or an address.
  /// @returns false where that is no name that a certificate could have, so that nothing would be
  ///     checked; the handshake must not begin then. A pinned certificate needs no name.
  [[nodiscard]] bool prepare(transport::Stream& stream, const std::string& host) const;
  /// Why the handshake has failed, for the user.
  std::string reason(transport::Stream& stream, const asio::error_code& error) const;

 private:
  transport::Stream::Context context_;
  bool pinned_;
};

}  // namespace cycloid::client
