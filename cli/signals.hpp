#pragma once

namespace cycloid::cli {

/// From now on SIGINT and SIGTERM ask instead of killing.
void catch_stop_signals();

/// Whether one of them came.
bool stop_requested();

}  // namespace cycloid::cli
