#include "client/net/tls.hpp"

#include <openssl/crypto.h>
#include <openssl/ssl.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>

#include <stdexcept>

#include "protocol/transport/fingerprint.hpp"

namespace cycloid::client {
namespace {

using transport::Fingerprint;
using transport::Stream;

/// A context and what its callback reads, with one lifetime.
struct PinnedContext {
  asio::ssl::context context{asio::ssl::context::tls_client};
  Fingerprint pin{};
};

/// Takes the place of all of OpenSSL's checks.
int is_pinned(X509_STORE_CTX* store, void* data) {
  const auto* pinned = static_cast<const PinnedContext*>(data);
  const X509* certificate = X509_STORE_CTX_get0_cert(store);
  if (certificate != nullptr) {
    const Fingerprint theirs = transport::fingerprint_of(certificate);
    if (CRYPTO_memcmp(theirs.data(), pinned->pin.data(), theirs.size()) == 0) return 1;
  }
  X509_STORE_CTX_set_error(store, X509_V_ERR_CERT_REJECTED);
  return 0;
}

Stream::Context pinned_context(const std::string& text) {
  const auto pin = transport::parse_fingerprint(text);
  if (!pin)
    throw std::runtime_error("fingerprint: \"" + text +
                             "\" is not 64 hexadecimal digits of SHA-256");
  auto pinned = std::make_shared<PinnedContext>();
  pinned->pin = *pin;
  SSL_CTX_set_cert_verify_callback(pinned->context.native_handle(), is_pinned, pinned.get());
  return Stream::Context(pinned, &pinned->context);
}

Stream::Context trusting_context(const std::string& ca_file) {
  auto context = std::make_shared<asio::ssl::context>(asio::ssl::context::tls_client);
  asio::error_code error;
  if (ca_file.empty()) {
    context->set_default_verify_paths(error);
  } else {
    context->load_verify_file(ca_file, error);
  }
  if (error) {
    const std::string what = ca_file.empty() ? "the system's certificates" : ca_file;
    throw std::runtime_error(what + ": no certificates in PEM: " + error.message());
  }
  return context;
}

}  // namespace

ClientTls::ClientTls(const TlsTrust& trust)
    : context_(trust.fingerprint.empty() ? trusting_context(trust.ca_file)
                                         : pinned_context(trust.fingerprint)),
      pinned_(!trust.fingerprint.empty()) {
  SSL_CTX* const handle = context_->native_handle();
  SSL_CTX_set_min_proto_version(handle, TLS1_2_VERSION);
  SSL_CTX_set_options(handle, SSL_OP_NO_COMPRESSION | SSL_OP_NO_RENEGOTIATION);
  context_->set_verify_mode(asio::ssl::verify_peer);
}

bool ClientTls::prepare(Stream& stream, const std::string& host) const {
  SSL* const handle = stream.tls()->native_handle();
  X509_VERIFY_PARAM* const checks = SSL_get0_param(handle);
  // OpenSSL takes an empty name for the wish to check none.
  if (host.empty()) return pinned_;
  if (X509_VERIFY_PARAM_set1_ip_asc(checks, host.c_str()) == 1) return true;
  X509_VERIFY_PARAM_set_hostflags(checks, X509_CHECK_FLAG_NO_PARTIAL_WILDCARDS);
  const bool checked = X509_VERIFY_PARAM_set1_host(checks, host.c_str(), host.size()) == 1;
  SSL_set_tlsext_host_name(handle, host.c_str());
  return checked || pinned_;
}

std::string ClientTls::reason(Stream& stream, const asio::error_code& error) const {
  SSL* const handle = stream.tls()->native_handle();
  const long verified = SSL_get_verify_result(handle);
  if (verified == X509_V_OK) {
    if (error.category() == asio::error::get_ssl_category())
      return "no TLS handshake: " + error.message() + "; does the server speak TLS here?";
    return "no TLS handshake: " + error.message();
  }
  const std::string why =
      pinned_ ? "it is not the pinned one" : X509_verify_cert_error_string(verified);
  return "the server's certificate is refused: " + why;
}

}  // namespace cycloid::client
