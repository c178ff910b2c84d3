#include "protocol/build_text.hpp"

#include "protocol/messages.hpp"
#include "protocol/utf8.hpp"

namespace cycloid::protocol {

std::string build_text() {
  return cut_utf8(CYCLOID_BUILD_TEXT, kBuildBytesMax);
}

}  // namespace cycloid::protocol
