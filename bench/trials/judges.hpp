#pragma once

#include <string>

#include "bench/trials/course.hpp"

namespace cycloid::trials {

enum class Verdict { kStands, kSags, kFails };

/// How a trial is judged: by one number, of which more is worse.
struct Judge {
  const char* trial;
  const char* metric;  ///< What the number is, with its unit.
  double (*measure)(const Course& course);
  double stands;  ///< Up to this it stands.
  double sags;    ///< Up to this it sags; beyond it has failed.
  Act<2> act = nullptr;
};

/// Of the trial of this name. @pre there is one, as for every entry of `scenes::trials()`.
const Judge& judge_of(const scenes::Trial& trial);

/// What came out of one trial under one method.
struct Outcome {
  Verdict verdict = Verdict::kFails;
  double value = 0.0;  ///< Of the judge's metric; meaningless where `ended` is false.
  bool ended = true;   ///< False: the world faulted, which is a failure.
};
Outcome judge(const scenes::Trial& trial, const solver::Tuning& method);
/// What the judge makes of a course that some engine has run.
Outcome judged(const Judge& by, const Course& course);

const char* verdict_name(Verdict verdict);  ///< "stands", "sags", "fails"
/// As the expected table says it: "sags 0.123", three digits; "fails" alone after a fault.
std::string outcome_text(const Outcome& outcome);

}  // namespace cycloid::trials
