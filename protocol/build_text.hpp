#pragma once

#include <string>

namespace cycloid::protocol {

/// The compiler, the flags and the processor that this library was built for, in at most
/// kBuildBytesMax bytes: for logs and for reports of desyncs, never for a decision.
std::string build_text();

}  // namespace cycloid::protocol
