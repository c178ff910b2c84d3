#pragma once

// Everything about logs, for those who write and read them whole.
#include "protocol/log/cursor.hpp"
#include "protocol/log/encoder.hpp"
#include "protocol/log/scan.hpp"
#include "protocol/log/values.hpp"
