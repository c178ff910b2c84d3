#pragma once

#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "protocol/utf8.hpp"

namespace cycloid::cli {

/// An element of an XML document, with what its references mean.
struct XmlElement {
  std::string name;
  std::map<std::string, std::string> attributes;
  std::string text;
  std::vector<XmlElement> children;
};

/// Reads the part of XML 1.0 that reports are written in, strictly: whatever a conforming parser
/// would refuse is thrown, and so is what it might take and a report has no use for.
class XmlReader {
 public:
  static XmlElement read(std::string_view text) {
    if (!protocol::is_utf8(text)) throw std::runtime_error("not UTF-8");
    XmlReader reader(text);
    reader.expect("<?xml version=\"1.0\" encoding=\"UTF-8\"?>");
    reader.skip_blanks();
    XmlElement root = reader.element();
    reader.skip_blanks();
    if (!reader.rest_.empty()) throw std::runtime_error("something behind the root element");
    return root;
  }

 private:
  explicit XmlReader(std::string_view text) : rest_(text) {}

  void expect(std::string_view word) {
    if (!rest_.starts_with(word)) {
      throw std::runtime_error("expected " + std::string(word) + " at " +
                               std::string(rest_.substr(0, 40)));
    }
    rest_.remove_prefix(word.size());
  }
  bool taken(std::string_view word) {
    if (!rest_.starts_with(word)) return false;
    rest_.remove_prefix(word.size());
    return true;
  }
  std::size_t skip_blanks() {
    const std::size_t blanks = std::min(rest_.find_first_not_of(" \t\r\n"), rest_.size());
    rest_.remove_prefix(blanks);
    return blanks;
  }
  std::string word() {
    const std::size_t end = rest_.find_first_not_of("abcdefghijklmnopqrstuvwxyz");
    if (end == 0 || end == rest_.npos) throw std::runtime_error("no name");
    const std::string name(rest_.substr(0, end));
    rest_.remove_prefix(end);
    return name;
  }

  /// Up to, not with, the character that ends it.
  std::string characters(char end) {
    std::string text;
    while (!rest_.empty() && rest_.front() != end) {
      const char c = rest_.front();
      rest_.remove_prefix(1);
      if (c == '&') {
        text += reference();
      } else if (c == '<' || c == '\x7f' || (c >= 0 && c < ' ' && c != '\n')) {
        throw std::runtime_error("a character that XML does not hold here");
      } else if (c == '\n' && end == '"') {
        throw std::runtime_error("a line end in a value, which would be read as a blank");
      } else {
        text += c;
      }
    }
    return text;
  }
  char reference() {
    expect("#");
    int code = 0;
    std::size_t digits = 0;
    for (; !rest_.empty() && rest_.front() >= '0' && rest_.front() <= '9' && digits < 4; ++digits) {
      code = 10 * code + rest_.front() - '0';
      rest_.remove_prefix(1);
    }
    expect(";");
    const bool held = code == '\t' || code == '\n' || code == '\r' || (code >= ' ' && code < 127);
    if (digits == 0 || !held) throw std::runtime_error("a reference to no character");
    return static_cast<char>(code);
  }

  XmlElement element() {
    expect("<");
    XmlElement element;
    element.name = word();
    while (skip_blanks() > 0 && !rest_.starts_with("/") && !rest_.starts_with(">")) {
      const std::string name = word();
      expect("=\"");
      const std::string value = characters('"');
      expect("\"");
      if (!element.attributes.emplace(name, value).second)
        throw std::runtime_error("the attribute " + name + " twice");
    }
    if (taken("/>")) return element;
    expect(">");
    for (;;) {
      element.text += characters('<');
      if (taken("</")) break;
      element.children.push_back(this->element());
    }
    expect(element.name);
    expect(">");
    return element;
  }

  std::string_view rest_;
};

}  // namespace cycloid::cli
