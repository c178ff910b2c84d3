#include "cli/demo_table.hpp"

#include <iomanip>
#include <iostream>

#include "cli/visible.hpp"

namespace cycloid::cli {
namespace {

std::string per_tick(std::uint64_t bytes, std::uint64_t ticks) {
  return ticks == 0 ? "-" : std::to_string((bytes + ticks / 2) / ticks);
}

}  // namespace

void judge(DemoResult& result) {
  for (const DemoPart& part : result.parts) {
    if (!part.there) continue;  // It has failed already, with its own words.
    if (part.ticks != result.ticks) {
      result.failures.push_back(part.name + " ended at tick " + std::to_string(part.ticks) +
                                " of " + std::to_string(result.ticks) +
                                "; is the machine overloaded? Try again with fewer --seconds");
    } else if (part.digest != result.parts.front().digest) {
      result.failures.push_back(part.name + " has another digest than " +
                                result.parts.front().name + "; see: cycloid replay " + result.log +
                                " --digest-every 1");
    }
  }
}

void print_table(const DemoResult& result) {
  std::cout << visible(result.scene) << ": " << result.ticks << " ticks\n\n"
            << std::left << std::setw(10) << "part" << std::setw(20) << "role" << std::right
            << std::setw(8) << "tick"
            << "  " << std::left << std::setw(18) << "final digest" << std::right << std::setw(12)
            << "bytes/tick" << std::setw(12) << "bytes/tick" << '\n'
            << std::setw(70) << "in" << std::setw(12) << "out" << '\n';
  for (const DemoPart& part : result.parts) {
    std::cout << std::left << std::setw(10) << part.name << std::setw(20) << part.role << std::right
              << std::setw(8) << part.ticks << "  " << std::left << std::setw(18)
              << (part.there ? part.digest : "none") << std::right << std::setw(12)
              << per_tick(part.bytes_in, part.ticks_present) << std::setw(12)
              << per_tick(part.bytes_out, part.ticks_present) << '\n';
  }
  std::cout << std::fixed << std::setprecision(3) << "\nworst tick " << result.worst_tick_ms
            << " ms of " << result.tick_ms << " ms; inputs replaced " << result.inputs_replaced
            << "; log " << result.log << '\n'
            << (result.failures.empty() ? "all equal\n" : "");
}

Json to_json(const DemoResult& result) {
  Json parts = Json::array();
  for (const DemoPart& part : result.parts) {
    parts.push_back({{"part", part.name},
                     {"role", part.role},
                     {"tick", part.ticks},
                     {"digest", part.digest},
                     {"ticks_present", part.ticks_present},
                     {"bytes_in", part.bytes_in},
                     {"bytes_out", part.bytes_out}});
  }
  return {{"scene", result.scene},
          {"ticks", result.ticks},
          {"equal", result.failures.empty()},
          {"parts", parts},
          {"worst_tick_ms", result.worst_tick_ms},
          {"tick_ms", result.tick_ms},
          {"inputs_replaced", result.inputs_replaced},
          {"log", result.log},
          {"failures", result.failures}};
}

}  // namespace cycloid::cli
