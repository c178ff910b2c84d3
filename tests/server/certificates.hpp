#pragma once

#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>

#include <cstdio>
#include <ctime>
#include <memory>
#include <string>

namespace cycloid::server {

/// A certificate and its key, made when the test runs.
struct Identity {
  std::shared_ptr<EVP_PKEY> key;
  std::shared_ptr<X509> certificate;
};

struct CertificateWish {
  std::string name = "test";
  std::string alternatives = "DNS:localhost,IP:127.0.0.1";  ///< "": it may sign others instead.
  long begins_s = -3600;                                    ///< From now.
  long ends_s = 3600;
};

inline void add_extension(X509* certificate, int kind, const std::string& value) {
  X509V3_CTX context;
  X509V3_set_ctx_nodb(&context);
  X509V3_set_ctx(&context, certificate, certificate, nullptr, nullptr, 0);
  X509_EXTENSION* extension = X509V3_EXT_conf_nid(nullptr, &context, kind, value.c_str());
  X509_add_ext(certificate, extension, -1);
  X509_EXTENSION_free(extension);
}

/// Signed by `issuer`, or by itself.
inline Identity make_identity(const CertificateWish& wish, const Identity* issuer = nullptr) {
  static long serial = 1;
  Identity made;
  made.key.reset(EVP_EC_gen("P-256"), EVP_PKEY_free);
  made.certificate.reset(X509_new(), X509_free);
  X509* const certificate = made.certificate.get();
  X509_set_version(certificate, 2);
  ASN1_INTEGER_set(X509_get_serialNumber(certificate), serial++);
  X509_gmtime_adj(X509_getm_notBefore(certificate), wish.begins_s);
  X509_gmtime_adj(X509_getm_notAfter(certificate), wish.ends_s);
  X509_set_pubkey(certificate, made.key.get());
  X509_NAME* const name = X509_get_subject_name(certificate);
  X509_NAME_add_entry_by_txt(name, "CN", MBSTRING_UTF8,
                             reinterpret_cast<const unsigned char*>(wish.name.c_str()), -1, -1, 0);
  const Identity& signer = issuer == nullptr ? made : *issuer;
  X509_set_issuer_name(certificate, X509_get_subject_name(signer.certificate.get()));
  if (wish.alternatives.empty()) {
    add_extension(certificate, NID_basic_constraints, "critical,CA:TRUE");
    add_extension(certificate, NID_key_usage, "critical,keyCertSign");
  } else {
    add_extension(certificate, NID_subject_alt_name, wish.alternatives);
  }
  X509_sign(certificate, signer.key.get(), EVP_sha256());
  return made;
}

inline void write_certificate(const std::string& file, const Identity& identity) {
  std::FILE* const out = std::fopen(file.c_str(), "wb");
  PEM_write_X509(out, identity.certificate.get());
  std::fclose(out);
}

/// @param password  Encrypts it; "": it stands there as it is.
inline void write_key(const std::string& file, const Identity& identity,
                      const std::string& password = "") {
  std::FILE* const out = std::fopen(file.c_str(), "wb");
  PEM_write_PKCS8PrivateKey(out, identity.key.get(), password.empty() ? nullptr : EVP_aes_256_cbc(),
                            password.data(), static_cast<int>(password.size()), nullptr, nullptr);
  std::fclose(out);
}

}  // namespace cycloid::server
