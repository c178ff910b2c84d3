#include <gtest/gtest.h>

#include <map>

#include "cli/output.hpp"
#include "cli/replaying.hpp"
#include "tests/hostile/matches.hpp"

namespace cycloid::hostile {
namespace {

/// What `cycloid verify` finds out about the bytes of a log.
struct Finding {
  std::string verdict;  ///< "corrupt", "incompatible", "diverged", "cut", or "good".
  std::vector<std::uint64_t> digests;
  std::string why;  ///< What the program would print.
};

Finding verified(std::span<const std::byte> bytes) {
  Finding finding;
  try {
    const cli::LoadedLog loaded = cli::parse_log("log", bytes);
    cli::ReplayOptions options;
    options.on_tick = [&](std::uint64_t, std::uint64_t digest) {
      finding.digests.push_back(digest);
    };
    const cli::Replayed replayed = cli::replay(loaded, options);
    finding.verdict = replayed.divergence ? "diverged" : loaded.blemish().empty() ? "good" : "cut";
    if (finding.verdict == "good") {
      EXPECT_EQ(finding.digests.size(), loaded.log.tick_count());
    }
  } catch (const cli::Failure& failure) {
    finding.why = failure.what();
    finding.verdict = failure.exit == cli::kExitIncompatible ? "incompatible" : "corrupt";
    EXPECT_TRUE(failure.exit == cli::kExitIncompatible || failure.exit == cli::kExitCorrupt);
  }
  return finding;
}

void flip(std::size_t bit, protocol::Bytes& bytes) {
  bytes[bit / 8] ^= static_cast<std::byte>(1u << (bit % 8));
}

void print(const std::map<std::string, int>& counts) {
  for (const auto& [verdict, count] : counts) std::printf("%s %d  ", verdict.c_str(), count);
  std::printf("\n");
}

class HostileLog : public testing::Test {
 protected:
  Match match = played("vehicle", 5);
  protocol::Bytes bytes = match.log;
  std::map<std::string, int> counts;

  bool is_prefix(const std::vector<std::uint64_t>& digests) const {
    return digests.size() <= match.digests.size() &&
           std::equal(digests.begin(), digests.end(), match.digests.begin());
  }
};

/// The state of a keyframe is made whatever it is, with checks that fit: it is not a state, not
/// that of its tick, or it diverges from the replay.
TEST(HostileKeyframe, FlipsWithChecksRemadeAreNeverGood) {
  const Match match = played("vehicle", 4, 2);
  ASSERT_EQ(match.ends.size(), 7u);
  std::map<std::string, int> found;
  for (std::size_t byte = match.ends[2]; byte < match.ends[3]; byte += 7) {
    protocol::Bytes damaged = match.log;
    flip(byte * 8 + byte % 8, damaged);
    refit_checks(match.checks, damaged);
    if (damaged == match.log) continue;  // It was the check itself.
    const Finding finding = verified(damaged);
    ++found[finding.verdict];
    ASSERT_NE(finding.verdict, "good") << byte;
    const protocol::LogSummary log = protocol::scan_log(damaged);
    if (log.state != protocol::LogState::kComplete) continue;
    // And where a reader begins with it, it is refused, or diverges, or has the digest it says.
    try {
      cli::ReplayOptions from_it;
      from_it.from = 2;
      const cli::LoadedLog loaded = cli::parse_log("log", damaged);
      const cli::Replayed replayed = cli::replay(loaded, from_it);
      if (!replayed.divergence) {
        EXPECT_EQ(replayed.digest, match.digests.back());
      }
    } catch (const cli::Failure& failure) {
      EXPECT_EQ(failure.exit, cli::kExitCorrupt);
    }
  }
  print(found);
}

/// What the log of a match that has not begun says of its state.
struct Beginning {
  std::uint64_t keyframe_digest = 0;
  std::uint64_t footer_digest = 0;
  bool with_keyframe = false;
};

protocol::Bytes log_of(const scenes::Scene& scene, const Beginning& beginning) {
  protocol::Bytes bytes;
  protocol::LogEncoder encoder(protocol::log_header_of(scene), bytes);
  if (beginning.with_keyframe) {
    protocol::Bytes state;
    scenes::Simulation::create(scene).value().encode(state);
    encoder.keyframe(beginning.keyframe_digest, state, bytes);
  }
  encoder.footer({0, beginning.footer_digest, {}}, bytes);
  return bytes;
}

/// No tick's digest stands beside these: they are held against the state itself.
TEST(HostileBeginning, ADigestThatIsNotOfTheFirstStateDiverges) {
  const scenes::Scene scene = catalogue_scene("vehicle");
  const std::uint64_t digest = scenes::Simulation::create(scene).value().digest();
  EXPECT_EQ(verified(log_of(scene, {0, digest, false})).verdict, "good");
  EXPECT_EQ(verified(log_of(scene, {0, digest ^ 1, false})).verdict, "diverged");
  EXPECT_EQ(verified(log_of(scene, {digest, digest, true})).verdict, "good");
  EXPECT_EQ(verified(log_of(scene, {digest ^ 1, digest ^ 1, true})).verdict, "diverged");
}

TEST_F(HostileLog, AsItIsItIsGood) {
  const Finding finding = verified(bytes);
  EXPECT_EQ(finding.verdict, "good") << finding.why;
  EXPECT_EQ(finding.digests, match.digests);
}

/// A bad disk: the checks are those of the original, so no flip at all passes for good.
TEST_F(HostileLog, EveryBitFlipIsDetected) {
  for (std::size_t bit = 0; bit < bytes.size() * 8; ++bit) {
    flip(bit, bytes);
    const Finding finding = verified(bytes);
    ASSERT_NE(finding.verdict, "good") << "bit " << bit;
    ASSERT_TRUE(is_prefix(finding.digests)) << "bit " << bit;
    ++counts[finding.verdict];
    flip(bit, bytes);
  }
  print(counts);
}

TEST_F(HostileLog, CutAtEveryByteItIsAPrefixOrCorrupt) {
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const Finding finding = verified(std::span(bytes).first(size));
    const bool whole_header = size >= match.ends[0];
    ASSERT_EQ(finding.verdict, whole_header ? "cut" : "corrupt") << size;
    ASSERT_TRUE(is_prefix(finding.digests)) << size;
    const auto next = std::upper_bound(match.ends.begin(), match.ends.end(), size);
    ASSERT_EQ(finding.digests.size(),
              whole_header
                  ? match.ticks_until[static_cast<std::size_t>(next - match.ends.begin() - 1)]
                  : 0u);
  }
}

/// A hostile writer remakes the checks. In the records after the header nothing but a seat's origin
/// and input that nothing listens to can then pass, and the digests are still those of the match.
TEST_F(HostileLog, FlipsOfRecordsWithChecksRemadeAreRefusedDivergeOrChangeNothing) {
  for (std::size_t bit = match.ends[0] * 8; bit < bytes.size() * 8; ++bit) {
    protocol::Bytes damaged = bytes;
    flip(bit, damaged);
    refit_checks(match.checks, damaged);
    const Finding finding = verified(damaged);
    ASSERT_TRUE(is_prefix(finding.digests)) << "bit " << bit;
    if (finding.verdict == "good") {
      ASSERT_EQ(finding.digests, match.digests) << "bit " << bit;
    }
    ++counts[finding.verdict];
  }
  print(counts);
  EXPECT_GT(counts["diverged"], 100);
  EXPECT_GT(counts["corrupt"], 100);
}

/// The scene inside is flipped, its digest and the checks are remade: it is refused, diverges, or
/// is a match of a scene that means the same.
TEST_F(HostileLog, FlipsOfTheHeaderWithChecksRemadeAreRefusedDivergeOrAreAMatch) {
  for (std::size_t bit = 0; bit < match.ends[0] * 8; ++bit) {
    protocol::Bytes damaged = bytes;
    flip(bit, damaged);
    refit_checks(match.checks, damaged);
    Finding finding = verified(damaged);
    const protocol::Log log = protocol::read_log(damaged);
    const scenes::Loaded scene = scenes::from_binary(log.header.scene);
    if (finding.verdict == "incompatible" && scene.scene && bit / 8 > kSaltPlace) {
      ++counts["digest remade"];
      solver::store_little(scenes::scene_digest(*scene.scene), damaged.data() + kSceneDigestPlace);
      refit_checks(match.checks, damaged);
      finding = verified(damaged);
    }
    if (finding.verdict == "good") {
      ASSERT_EQ(finding.digests, match.digests) << "bit " << bit;
    }
    ++counts[finding.verdict];
  }
  print(counts);
  EXPECT_GT(counts["diverged"], 100);
  EXPECT_GT(counts["corrupt"], 1000);
}

}  // namespace
}  // namespace cycloid::hostile
