#include "cli/run_log.hpp"

#include <cerrno>
#include <utility>

#include "cli/output.hpp"
#include "cli/whole_file.hpp"

namespace cycloid::cli {

OutputFile::OutputFile(std::string file)
    : file_(std::move(file)), stream_(file_, std::ios::binary | std::ios::trunc) {
  check();
}

void OutputFile::check() {
  if (!stream_) throw Failure(kExitIo, unwritable_text(file_, errno));
}

void OutputFile::write(std::span<const std::byte> bytes) {
  errno = 0;
  stream_.write(reinterpret_cast<const char*>(bytes.data()),
                static_cast<std::streamsize>(bytes.size()));
  check();
}

void OutputFile::close() {
  stream_.close();
  check();
}

RunLog::RunLog(std::string file, const scenes::Scene& scene, std::uint64_t keyframe_every)
    : file_(std::move(file)), keyframe_every_(keyframe_every) {
  protocol::LogHeader header = protocol::log_header_of(scene);
  header.salt = header.scene_digest;
  header.log_id = header.scene_digest;
  encoder_.emplace(header, bytes_);
}

void RunLog::tick(const protocol::InputFrame& frame, const scenes::Simulation& simulation) {
  encoder_->tick({frame, simulation.digest()}, bytes_);
  if (keyframe_every_ != 0 && frame.tick % keyframe_every_ == 0) {
    state_.clear();
    simulation.encode(state_);
    encoder_->keyframe(simulation.digest(), state_, bytes_);
  }
  write();
}

void RunLog::finish(const scenes::Simulation& simulation) {
  encoder_->footer({simulation.tick(), simulation.digest(), {}}, bytes_);
  write();
  file_.close();
}

void RunLog::write() {
  file_.write(bytes_);
  bytes_.clear();
}

}  // namespace cycloid::cli
