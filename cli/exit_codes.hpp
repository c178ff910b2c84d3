#pragma once

namespace cycloid::cli {

/// Exit codes are interface: scripts and CI tell these cases apart.
enum Exit : int {
  kExitGood = 0,
  kExitDiverged = 1,      ///< Two things that must be equal are not, or a world faulted.
  kExitUsage = 2,         ///< The command line asks for something that does not exist.
  kExitCorrupt = 3,       ///< A scene, log or message is not what it should be.
  kExitIncompatible = 4,  ///< Another format, protocol or solver version, or another scene.
  kExitIo = 5,            ///< A file, a socket or a process failed, or nothing was found.
  kExitTimeout = 124,     ///< Not done in the time given, and nothing worse.
};

/// The footer of every --help.
inline constexpr const char* kExitCodesText =
    "Exit codes: 0 good, 1 diverged, 2 usage, 3 corrupt, 4 incompatible, 5 input/output, "
    "124 timeout.";

}  // namespace cycloid::cli
