#pragma once

#include <vector>

#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

struct Setting {
  const char* name;
  Tuning tuning;
};

/// The published methods, with sleeping off.
inline std::vector<Setting> method_settings() {
  std::vector<Setting> all = {{"soft_step", Tuning::soft_step()},
                              {"pgs", Tuning::pgs()},
                              {"split_impulse", Tuning::split_impulse()},
                              {"pgs_ngs", Tuning::pgs_ngs()},
                              {"pgs_ngs_block", Tuning::pgs_ngs_block()},
                              {"pgs_soft", Tuning::pgs_soft()},
                              {"tgs_ngs", Tuning::tgs_ngs()},
                              {"xpbd", Tuning::xpbd()}};
  for (Setting& setting : all) setting.tuning.sleep_s = 0.0f;
  return all;
}

}  // namespace cycloid::solver
