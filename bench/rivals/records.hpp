#pragma once

#include <string>

#include "bench/rivals/rival_run.hpp"

namespace cycloid::rivals {

/// Which runs bench/peers/node/record.mjs makes of a scene, ours as WebAssembly among them.
struct RecordedSettings {
  std::vector<accuracy::Setting> ours;
  std::vector<std::uint32_t> substeps;  ///< Of every other engine.
};

/// Writes to a folder that is there what record.mjs reads: runs.json, the list of runs, and the
/// scenes as each of our settings solves them, without sleep. Scenes with seats, or in which
/// something happens besides what they say, are left out. Throws std::runtime_error where a file
/// cannot be written.
void export_runs(const std::vector<accuracy::SceneChart>& charts, const RecordedSettings& settings,
                 const std::string& folder);

/// The runs that record.mjs has made in a folder: a contender for each setting, who takes part in
/// the scenes of which there is a record. Throws std::runtime_error that names the file which is
/// missing, or is not what it should be.
std::vector<accuracy::Contender> recorded_contenders(const std::string& folder);

}  // namespace cycloid::rivals
