#pragma once

#include <string>

namespace cycloid::figures {

/// "AMD EPYC, 2 processors"
std::string machine_text();

/// Today by the machine's clock, UTC: "2026-11-21".
std::string date_text();

}  // namespace cycloid::figures
