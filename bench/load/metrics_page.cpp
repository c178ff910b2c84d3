#include "bench/load/metrics_page.hpp"

#include <asio.hpp>
#include <cmath>
#include <limits>
#include <sstream>

namespace cycloid::load {
namespace {

const std::string kBucket = "_bucket";

/// The value of le="..." in a series, infinite for +Inf.
double edge_of(const std::string& series) {
  const std::size_t at = series.find("le=\"");
  if (at == std::string::npos) return 0.0;
  const std::string text = series.substr(at + 4, series.find('"', at + 4) - at - 4);
  return text == "+Inf" ? std::numeric_limits<double>::infinity() : std::stod(text);
}

}  // namespace

MetricsPage MetricsPage::fetch(std::uint16_t port) {
  asio::io_context io;
  asio::ip::tcp::socket socket(io);
  socket.connect({asio::ip::address_v4::loopback(), port});
  const std::string request = "GET /metrics HTTP/1.0\r\nHost: localhost\r\n\r\n";
  asio::write(socket, asio::buffer(request));
  std::string text;
  asio::error_code ended;
  (void)asio::read(socket, asio::dynamic_buffer(text), ended);
  const std::size_t head = text.find("\r\n\r\n");
  return MetricsPage(head == std::string::npos ? std::string() : text.substr(head + 4));
}

MetricsPage::MetricsPage(const std::string& text) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t space = line.rfind(' ');
    if (line.empty() || line[0] == '#' || space == std::string::npos) continue;
    const std::string series = line.substr(0, space);
    const std::string name = series.substr(0, series.find('{'));
    const double value = std::stod(line.substr(space + 1));
    sums_[name] += value;
    if (name.size() <= kBucket.size() || name.substr(name.size() - kBucket.size()) != kBucket) {
      continue;
    }
    buckets_[name.substr(0, name.size() - kBucket.size())][edge_of(series)] += value;
  }
}

double MetricsPage::sum(const std::string& name) const {
  const auto found = sums_.find(name);
  return found == sums_.end() ? 0.0 : found->second;
}

double MetricsPage::quantile_ms(const std::string& name, double quantile,
                                const MetricsPage& before) const {
  const auto mine = buckets_.find(name);
  if (mine == buckets_.end() || mine->second.empty()) return 0.0;
  const auto theirs = before.buckets_.find(name);
  const auto since = [&](double edge, double count) {
    if (theirs == before.buckets_.end()) return count;
    const auto at = theirs->second.find(edge);
    return at == theirs->second.end() ? count : count - at->second;
  };
  const auto& last = *mine->second.rbegin();
  const double all = since(last.first, last.second);
  for (const auto& [edge, count] : mine->second) {
    if (all > 0.0 && since(edge, count) >= quantile * all) return edge * 1e3;
  }
  return 0.0;
}

}  // namespace cycloid::load
