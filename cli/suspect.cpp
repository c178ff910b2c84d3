#include <algorithm>
#include <charconv>
#include <sstream>
#include <utility>

#include "cli/blame.hpp"
#include "cli/child.hpp"
#include "cli/files.hpp"
#include "cli/trace_text.hpp"

namespace cycloid::cli {
namespace {

class SuspectHere : public Suspect {
 public:
  SuspectHere(std::string name, const Match& match) : name_(std::move(name)), match_(match) {}
  std::string name() const override { return name_; }
  Course course(std::uint64_t last_tick) const override {
    return run_course(match_, last_tick, {});
  }
  TickTrace trace(std::uint64_t tick, const TraceDetail& detail) const override {
    return trace_tick(match_, tick, detail, {});
  }

 private:
  std::string name_;
  const Match& match_;
};

/// "12 0123456789abcdef" lines, tick after tick.
std::optional<Course> course_from_lines(const std::string& lines) {
  Course course;
  std::istringstream stream(lines);
  std::uint64_t tick = 0;
  std::string text;
  while (stream >> tick >> text) {
    std::uint64_t digest = 0;
    const char* end = text.data() + text.size();
    if (course.digests.empty()) course.begin = tick;
    const bool read = std::from_chars(text.data(), end, digest, 16).ptr == end;
    if (!read || tick != course.begin + course.digests.size()) return std::nullopt;
    course.digests.push_back(digest);
  }
  if (!stream.eof() || course.digests.empty()) return std::nullopt;
  return course;
}

class SuspectThere : public Suspect {
 public:
  SuspectThere(const OtherBuild& build, const Match& match)
      : program_(build.program), match_(match.name), begin_(match.begin()) {
    std::istringstream words(build.runner);
    for (std::string word; words >> word;) command_.push_back(word);
    const bool beside = program_.find('/') == std::string::npos && kind_of(program_).is_file;
    command_.push_back(beside ? "./" + program_ : program_);  // Not one of that name in PATH.
    command_.insert(command_.end(), {"trace", match_});
    const bool whole = !match.log || (match.exit() == kExitGood && !match.log->salvaged);
    if (!whole) command_.push_back("--salvage");  // As far as it goes here, with nothing to say.
  }
  std::string name() const override { return program_; }

  Course course(std::uint64_t last_tick) const override {
    const std::string out = run({"--ticks", std::to_string(last_tick - begin_)});
    std::optional<Course> course = course_from_lines(out);
    if (!course) throw Failure(kExitIo, program_ + ": trace: not lines of 'tick digest'");
    if (course->begin != begin_) {
      throw Failure(kExitIo, program_ + ": trace: begins with tick " +
                                 std::to_string(course->begin) + ", " + match_ + " with tick " +
                                 std::to_string(begin_));
    }
    if (course->last_tick() < last_tick) course->fault = "the world does not step";
    return std::move(*course);
  }

  TickTrace trace(std::uint64_t tick, const TraceDetail& detail) const override {
    std::vector<std::string> arguments = {"--tick", std::to_string(tick), "--json"};
    if (detail.objects) arguments.push_back("--objects");
    if (!detail.object.empty()) arguments.insert(arguments.end(), {"--object", detail.object});
    const Json json = Json::parse(run(arguments), nullptr, /*allow_exceptions=*/false);
    std::optional<TickTrace> trace = trace_from_json(json);
    if (!trace) throw Failure(kExitIo, program_ + ": trace: not the JSON of a tick's phases");
    return std::move(*trace);
  }

 private:
  std::string run(const std::vector<std::string>& arguments) const {
    constexpr std::size_t kTraceBytesMax = std::size_t{1} << 30;
    std::vector<std::string> command = command_;
    command.insert(command.end(), arguments.begin(), arguments.end());
    Child child(program_, command, kTraceBytesMax);
    pump({&child}, std::chrono::steady_clock::time_point::max(), [&] { return child.finished(); });
    const int code = child.exit_code().value_or(kExitIo);
    if (code == kExitGood || (code == kExitDiverged && !child.out().empty())) return child.out();
    std::string words =
        child.err().substr(child.err().size() - std::min<std::size_t>(child.err().size(), 1000));
    if (code == 127 && words.empty()) words = "cannot be started";
    throw Failure(kExitIo, program_ + ": trace " + match_ + " ended with " + std::to_string(code) +
                               ": " + words);
  }

  std::string program_;
  std::string match_;
  std::uint64_t begin_;
  std::vector<std::string> command_;
};

}  // namespace

std::unique_ptr<Suspect> suspect_here(std::string name, const Match& match) {
  return std::make_unique<SuspectHere>(std::move(name), match);
}

std::unique_ptr<Suspect> suspect_there(const OtherBuild& build, const Match& match) {
  return std::make_unique<SuspectThere>(build, match);
}

}  // namespace cycloid::cli
