#include <gtest/gtest.h>
#include <sys/stat.h>

#include <string>

#include "server/config/config.hpp"
#include "tests/server/certificates.hpp"
#include "tests/server/config_fixture.hpp"

namespace cycloid::server {
namespace {

/// Into which nobody writes: to open it for reading would wait for ever.
TEST(ConfigChecks, APipeIsNoFileAndIsNotWaitedFor) {
  const ConfigFile pipe("pipe");
  ASSERT_EQ(::mkfifo(pipe.path().c_str(), 0600), 0);
  const std::string named = "\"" + pipe.path() + "\"\n";
  const ConfigResult read =
      read_config("[admin]\ntoken_file = " + named + "[admission]\nkeys_file = " + named +
                      "[tls]\nmode = \"required\"\ncertificate_file = " + named +
                      "key_file = " + named + kConfigRooms,
                  load_for_test);
  EXPECT_EQ(config_mistakes_text("f", read.mistakes),
            "f:2: admin.token_file: " + pipe.path() +
                ": cannot be read\nf:4: admission.keys_file: " + pipe.path() +
                ": cannot be read\nf:7: tls.certificate_file: " + pipe.path() + ": cannot be read");
  const ConfigResult itself = read_config_file(pipe.path(), load_for_test);
  EXPECT_EQ(config_mistakes_text("f", itself.mistakes), "f: the file cannot be read");
}

/// The one file is good.
TEST(ConfigChecks, AMistakeInTheKeyOfTlsIsNotTheCertificates) {
  const ConfigFile certificate("certificate");
  const ConfigFile key("key");
  const Identity identity = make_identity({});
  write_certificate(certificate.path(), identity);
  write_key(key.path(), identity);
  const ConfigFile other("no-key");
  other.write("none\n");
  const auto keys_of = [](const std::string& chain, const std::string& private_key) {
    const ConfigResult read =
        read_config("[tls]\nmode = \"required\"\ncertificate_file = \"" + chain +
                        "\"\nkey_file = \"" + private_key + "\"\n" + kConfigRooms,
                    load_for_test);
    std::string keys;
    for (const ConfigMistake& mistake : read.mistakes)
      keys += mistake.key + ":" + std::to_string(mistake.line) + " ";
    return keys;
  };
  EXPECT_EQ(keys_of(certificate.path(), key.path()), "");
  EXPECT_EQ(keys_of(certificate.path(), other.path()), "tls.key_file:4 ");
  EXPECT_EQ(keys_of(certificate.path(), "/no/such"), "tls.key_file:4 ");
  EXPECT_EQ(keys_of(other.path(), key.path()), "tls.certificate_file:3 ");
}

}  // namespace
}  // namespace cycloid::server
