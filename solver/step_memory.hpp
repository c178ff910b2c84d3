#pragma once

#include <memory>
#include <utility>

#include "solver/step_scratch.hpp"

namespace cycloid::solver {

/// Where steps find their memory: a piece for each thread that steps at the same time.
template <int D>
struct StepMemory : Depot<StepScratch<D>> {};

/// The memory of one step, with what its world keeps, as long as this lives.
template <int D>
class StepLoan {
 public:
  StepLoan(StepMemory<D>& memory, KeptByWorld<D>& kept)
      : memory_(memory), scratch_(memory.borrow()) {
    scratch_->kept = &kept;
  }
  StepLoan(const StepLoan&) = delete;
  StepLoan& operator=(const StepLoan&) = delete;
  ~StepLoan() {
    scratch_->kept = nullptr;
    // Or the next edit of the world would have to make a copy.
    scratch_->before.shapes = {};
    scratch_->before.links = {};
    memory_.give_back(std::move(scratch_));
  }
  StepScratch<D>& scratch() { return *scratch_; }

 private:
  StepMemory<D>& memory_;
  std::unique_ptr<StepScratch<D>> scratch_;
};

}  // namespace cycloid::solver
