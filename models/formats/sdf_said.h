// What libsdformat prints and reports, as a message of ours: which element, in which line, and what is wrong first.
#pragma once

#include <sdf/Error.hh>
#include <sdf/Types.hh>
#include <tinyxml2.h>

#include <mutex>
#include <sstream>
#include <string>
#include <vector>

#include "models/formats/xml_lines.h"

namespace delassus {

/// What libsdformat prints for as long as this lives, kept. Its console is global: one file at a time.
class SdfConsole {
 public:
  SdfConsole();
  ~SdfConsole();
  SdfConsole(const SdfConsole&) = delete;
  SdfConsole& operator=(const SdfConsole&) = delete;
  /// One entry per message, without colours and lines of the library's own source.
  [[nodiscard]] std::vector<std::string> messages() const;

 private:
  std::lock_guard<std::mutex> lock_;
  std::ostringstream text_;
  int level_;  // of console_bridge, through which libsdformat's attempt at URDF speaks
};

struct SdfSaid {
  std::string element;   ///< `joint "j" (line 4)`, as far as it is known
  std::string text;
  std::string accepted = "see what it says";
};

/// The first cause and at most two more; of what follows from them nothing. `errors` has one entry or more, `root` is what was read.
[[nodiscard]] SdfSaid sdf_said(const sdf::Errors& errors, const std::vector<std::string>& printed, const XmlLines& lines,
                               const tinyxml2::XMLElement& root);

/// A printed message, its place taken from where the library puts it: `[/sdf/model[@name="m"]:<data-string>:L2]: …`.
[[nodiscard]] SdfSaid sdf_said(const std::string& printed);

}  // namespace delassus
