#include "solver/result.hpp"

namespace cycloid::solver {

const char* code_name(Code code) {
  switch (code) {
    case Code::kOk:
      return "ok";
    case Code::kInvalid:
      return "invalid";
    case Code::kCapacity:
      return "capacity";
    case Code::kUnknownId:
      return "unknown id";
    case Code::kFaulted:
      return "faulted";
    case Code::kCorrupt:
      return "corrupt";
  }
  return "unknown";
}

}  // namespace cycloid::solver
