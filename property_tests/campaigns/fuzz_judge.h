// What a loader made of a text that may be broken: refused in words, or loaded as what it says.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace delassus {

struct FuzzText {
  std::string format;   ///< extension: urdf, yaml, json, xml (MJCF), sdf
  std::string text;
};

/// Sound texts that use all of their format: they load without a warning or a note.
[[nodiscard]] std::vector<FuzzText> fuzz_texts();

struct FuzzVerdict {
  bool loaded = false;
  std::string message;   ///< of the refusal, or of what was found doubtful
  std::string finding;   ///< empty: as it should be
};

/// Reads the text from a file in `folder`, through the loader of its format. A finding is
///   an exception that is no ModelError, or a ModelError that does not name the file;
///   URDF: a model that differs from reference/urdf_witness.h in a total mass, in M or in J, or a text that the witness
///   does not take for a URDF, unless a warning says so; an M that the witness finds singular or indefinite; elements that
///   URDF does not have, or that stand twice, without a note or a warning;
///   MJCF, SDF: a model that differs in M or J from MuJoCo's numbers, or from reference/sdf_witness.h, or a text that the
///   second reading does not take, unless a warning says so; SDF elements that stand twice; numbers of an MJCF that are none;
///   YAML: masses of boxes that differ from the text's, unless a warning says so;
///   JSON: a key or a value of the text that is not in the spec.
/// (A crash and a hang are for the caller to see.) `folder` holds fuzz.urdf for the scenes.
[[nodiscard]] FuzzVerdict judge_text(const FuzzText& text, const std::string& folder, std::uint64_t seed);

/// Writes what the scenes of fuzz_texts refer to.
void prepare_fuzz_folder(const std::string& folder);

}  // namespace delassus
