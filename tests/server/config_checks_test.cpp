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

/// Of a match that late spectators see as long as they do, what it keeps has bounds that hold.
TEST(ConfigChecks, ADelayThatWhatIsKeptHasNoRoomForIsRefused) {
  const auto mistakes = [](const std::string& limits, const std::string& delay_ticks) {
    const ConfigResult read =
        read_config("[limits]\n" + limits + "\n[template.late]\nscene = \"two-seats\"\n" +
                        "spectator_delay_ticks = " + delay_ticks + "\n" + kConfigRooms,
                    load_for_test);
    return config_mistakes_text("f", read.mistakes);
  };
  const std::string key = "f:5: template.late.spectator_delay_ticks: ";
  EXPECT_EQ(mistakes("frames_kept = 1000", "880"), "");
  EXPECT_EQ(mistakes("frames_kept = 1000", "881"),
            key +
                "it and twice limits.keyframe_ticks are 1001 frames, of at most 1000 that "
                "limits.frames_kept allows");
  EXPECT_EQ(mistakes("keyframe_ticks = 100000\nframes_kept = 1", "0"), "");
  const std::string states = mistakes("keyframe_bytes = 65536", "3480");
  EXPECT_EQ(states.substr(0, states.find(" bytes"))
                .find(key + "with limits.keyframe_ticks it "
                            "needs 60 kept states, which take "),
            0u)
      << states;
  EXPECT_NE(states.find("of at most 65536 that limits.keyframe_bytes allows"), std::string::npos);
  EXPECT_EQ(mistakes("", "3480"), "");
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
