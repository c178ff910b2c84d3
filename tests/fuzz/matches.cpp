#include "tests/hostile/matches.hpp"

#include "protocol/codec.hpp"
#include "tests/fuzz/targets.hpp"
#include "tests/protocol/samples.hpp"

namespace cycloid::fuzz {

/// Whether a few ticks of it take a fuzzer's time, not a user's.
static bool is_cheap(const scenes::Scene& scene) {
  const solver::Tuning& tuning = scene.tuning;
  const std::uint32_t sweeps = tuning.sweeps + tuning.relax_sweeps + tuning.position_sweeps;
  std::uint64_t particles = 0;
  for (const scenes::Cloth& cloth : scene.cloths)
    particles += std::uint64_t{cloth.columns} * cloth.rows;
  return tuning.substeps * sweeps <= 256 &&
         tuning.particle_substeps * tuning.particle_sweeps <= 256 && scene.bodies.size() < 1000 &&
         particles < 5000;
}

/// What `check` finds no mistake in has to run, and its encoding has to be taken.
static void play(const scenes::Scene& scene, std::span<const protocol::LogTick> ticks) {
  if (!is_cheap(scene)) return;
  auto made = scenes::Simulation::create(scene);
  if (!made.ok()) fail("a checked scene cannot run");
  scenes::Simulation simulation = std::move(made.value());
  for (const protocol::LogTick& tick : ticks) {
    std::vector<scenes::SeatInput> inputs;
    for (const protocol::SeatFrame& seat : tick.frame.seats) inputs.push_back(seat.input);
    inputs.resize(static_cast<std::size_t>(simulation.seats()));
    const solver::Error error = simulation.step(inputs);
    if (!error.ok() && error.code != solver::Code::kFaulted) fail("a step fails");
  }
  Seed bytes;
  simulation.encode(bytes);
  scenes::Simulation copy = std::move(scenes::Simulation::create(scene).value());
  if (!copy.decode(bytes).ok()) fail("a simulation refuses its own state");
  if (copy.digest() != simulation.digest()) fail("a simulation is another one when decoded");
}

static std::vector<protocol::LogTick> pressed_ticks() {
  std::vector<protocol::LogTick> ticks(3);
  for (std::size_t i = 0; i < ticks.size(); ++i)
    ticks[i].frame.seats.assign(
        4, {protocol::Origin::kGiven,
            {{32767, -32768, 1, 0}, static_cast<std::uint16_t>(i % 2 == 0 ? 0xffff : 0)}});
  return ticks;
}

static const hostile::Match& good_match() {
  static const hostile::Match kMatch = hostile::played("vehicle", 3, 2);
  return kMatch;
}

void run_log(Input input) {
  const unsigned mode = mode_of(input);
  const hostile::Match& match = good_match();
  Seed bytes(input.begin(), input.end());
  if (mode % 2 == kEditMode) {
    bytes = edited(match.log, input);
    if (mode % 4 == 3 && bytes.size() == match.log.size())
      hostile::refit_checks(match.checks, bytes);
  }
  const protocol::LogSummary log = protocol::scan_log(bytes);
  if (log.good_bytes + log.lost_bytes != bytes.size()) fail("bytes neither good nor lost");
  if (log.good_bytes == 0) return;
  // What is good is good again without the rest, and a reader can begin at every keyframe of it.
  const std::span<const std::byte> good(bytes.data(), static_cast<std::size_t>(log.good_bytes));
  const protocol::LogSummary again = protocol::scan_log(good);
  if (again.last_tick != log.last_tick || again.good_bytes != log.good_bytes)
    fail("a good prefix is another one by itself");
  for (const protocol::KeyframePlace& place : log.keyframes)
    if (protocol::LogCursor(good, log.start, place).next() != protocol::LogCursor::Step::kKeyframe)
      fail("a keyframe is not where it was found");
  const scenes::Loaded loaded = scenes::from_binary(log.header.scene);
  if (!loaded.scene) return;
  (void)scenes::scene_digest(*loaded.scene);
  std::vector<protocol::LogTick> ticks;
  protocol::LogCursor cursor(good, log.start);
  while (ticks.size() < 5) {
    const protocol::LogCursor::Step step = cursor.next();
    if (step == protocol::LogCursor::Step::kEnd) break;
    if (step == protocol::LogCursor::Step::kTick) ticks.push_back(cursor.tick());
    if (step != protocol::LogCursor::Step::kKeyframe || !is_cheap(*loaded.scene)) continue;
    auto made = scenes::Simulation::create(*loaded.scene);
    if (made.ok() && made.value().decode(cursor.keyframe().state).ok()) (void)made.value().digest();
  }
  play(*loaded.scene, ticks);
}

std::vector<Seed> log_seeds() {
  return {with_mode(kRawMode, good_match().log),
          with_mode(kEditMode, std::vector<std::byte>(8, std::byte{1})),
          with_mode(3, std::vector<std::byte>(16, std::byte{1}))};
}

void run_scene_json(Input input) {
  const auto* text = reinterpret_cast<const char*>(input.data());
  const scenes::Loaded loaded = scenes::from_json({text, input.size()});
  if (loaded.scene.has_value() != loaded.mistakes.empty()) fail("neither a scene nor a mistake");
  if (!loaded.scene) return;
  // JSON holds every float to the digit, so what is written is what was read.
  const scenes::Loaded again = scenes::from_json(scenes::to_json(*loaded.scene));
  if (!again.scene) fail("a scene written as JSON is refused: " + again.mistakes[0].path);
  if (is_cheap(*loaded.scene) &&
      scenes::scene_digest(*again.scene) != scenes::scene_digest(*loaded.scene))
    fail("a scene written as JSON means something else");
  play(*loaded.scene, pressed_ticks());
}

static const std::vector<std::string>& small_scenes() {
  static const std::vector<std::string> kNames = {
      "newtons-cradle", "character-course", "character-course-3d", "dzhanibekov",
      "cloth",          "stack-10",         "stack-10-3d",         "vehicle",
      "vehicle-3d",     "overlap"};
  return kNames;
}

std::vector<Seed> scene_json_seeds() {
  std::vector<Seed> seeds;
  for (const std::string& name : small_scenes()) {
    const std::string text = scenes::to_json(hostile::catalogue_scene(name));
    const auto* begin = reinterpret_cast<const std::byte*>(text.data());
    seeds.emplace_back(begin, begin + text.size());
  }
  return seeds;
}

void run_scene_binary(Input input) {
  static const std::vector<Seed> kGood = [] {
    std::vector<Seed> good;
    for (const std::string& name : small_scenes())
      good.push_back(scenes::to_binary(hostile::catalogue_scene(name)));
    return good;
  }();
  const unsigned mode = mode_of(input);
  const Seed bytes = mode % 2 == kRawMode ? Seed(input.begin(), input.end())
                                          : edited(kGood[mode / 2 % kGood.size()], input);
  const scenes::Loaded loaded = scenes::from_binary(bytes);
  if (loaded.scene.has_value() != loaded.mistakes.empty()) fail("neither a scene nor a mistake");
  if (!loaded.scene) return;
  const scenes::Loaded again = scenes::from_binary(scenes::to_binary(*loaded.scene));
  if (!again.scene) fail("a scene written as binary is refused: " + again.mistakes[0].path);
  play(*loaded.scene, pressed_ticks());
}

std::vector<Seed> scene_binary_seeds() {
  std::vector<Seed> seeds;
  for (const std::string& name : small_scenes())
    seeds.push_back(with_mode(kRawMode, scenes::to_binary(hostile::catalogue_scene(name))));
  for (unsigned i = 0; i < small_scenes().size(); ++i)
    seeds.push_back(with_mode(2 * i + 1, std::vector<std::byte>(8, std::byte{1})));
  return seeds;
}

/// Cuts a stream at places that the input chooses; every payload goes to the decoder of a
/// direction.
template <class Decode>
static void run_stream(Input input, std::uint32_t limit, Decode&& decode) {
  protocol::Framer framer(limit);
  std::size_t cut = 1;
  while (!input.empty()) {
    const std::size_t count = std::min(input.size(), cut);
    if (!framer.feed(input.first(count))) return;
    cut = 1 + static_cast<std::size_t>(input[0]) % 64;
    input = input.subspan(count);
    while (const auto payload = framer.next()) {
      if (payload->size() > limit) fail("a payload over the limit");
      const auto decoded = decode(*payload);
      if (decoded.message.has_value() != decoded.error.empty()) fail("neither message nor error");
      if (!decoded.message) continue;
      // What was understood can be said again, and is understood alike.
      const protocol::Bytes again = encode(*decoded.message);
      if (!decode(protocol::samples::payload_of(again)).message) fail("its own message is refused");
    }
    if (framer.held_bytes() > std::size_t{limit} + 64 + protocol::Framer::kPrefixBytes)
      fail("the framer holds more than one message");
  }
}

void run_messages(Input input) {
  const unsigned mode = mode_of(input);
  if (mode % 2 == 0)
    run_stream(input, protocol::kClientMessageBytesMax, protocol::decode_client);
  else
    run_stream(input, 1u << 16, protocol::decode_server);
}

std::vector<Seed> message_seeds() {
  std::vector<Seed> seeds;
  for (const protocol::ClientMessage& message : protocol::samples::client_messages())
    seeds.push_back(with_mode(0, protocol::encode(message)));
  for (const protocol::ServerMessage& message : protocol::samples::server_messages())
    seeds.push_back(with_mode(1, protocol::encode(message)));
  return seeds;
}

}  // namespace cycloid::fuzz
