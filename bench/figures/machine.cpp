#include "bench/figures/machine.hpp"

#include <chrono>
#include <cstdio>
#include <fstream>
#include <thread>

namespace cycloid::figures {

std::string machine_text() {
  std::string model = "an unknown processor";
  std::ifstream stream("/proc/cpuinfo");
  for (std::string line; std::getline(stream, line);)
    if (line.starts_with("model name")) {
      model = line.substr(line.find(':') + 2);
      break;
    }
  return model + ", " + std::to_string(std::thread::hardware_concurrency()) + " processors";
}

std::string date_text() {
  using namespace std::chrono;
  const year_month_day today{floor<days>(system_clock::now())};
  char text[32];
  std::snprintf(text, sizeof text, "%04d-%02u-%02u", static_cast<int>(today.year()),
                static_cast<unsigned>(today.month()), static_cast<unsigned>(today.day()));
  return text;
}

}  // namespace cycloid::figures
