// The XML of an MJCF file beside MuJoCo: includes put in place, what needs missing files taken out, exact inertias.
#pragma once

#include <tinyxml2.h>

#include <map>
#include <string>
#include <vector>

#include "algorithms/problem/problem.h"
#include "models/formats/mjcf_said.h"

namespace delassus {

/// A connect or weld between two sites: newer versions only.
struct SiteEquality {
  std::string name, site1, site2;
  bool weld, active;
};

[[nodiscard]] inline std::string name_of(const SiteEquality& s) { return s.name.empty() ? "sites " + s.site1 + " - " + s.site2 : s.name; }

class MjcfXml {
 public:
  /// Reads a file and everything it includes. A file that XML cannot be read from is left to MuJoCo's own message.
  explicit MjcfXml(const std::string& file);
  [[nodiscard]] bool empty() const { return doc_.Error() || doc_.RootElement() == nullptr; }

  /// Takes out meshes, height fields, textures and skins whose files are missing, the geoms that are made of them, and
  /// all that refers to them. @returns false when nothing was missing. @throws ModelError when the mass of a moving body, or a
  /// primitive fitted to a mesh, depends on a missing file.
  bool strip_missing_files();
  /// Takes out what MuJoCo 2.2 may not know and M, J and contacts do not need (visuals, sensors, actuators, options of the
  /// solver), and says by its words what newer versions mean by silence: autolimits, assetdir, a short polycoef.
  void respell_newer();
  [[nodiscard]] const std::vector<std::string>& left_out() const { return left_out_; }
  /// A link that the file fixes to the world lost geoms that its inertia comes from.
  [[nodiscard]] bool fixed_inertia_lost() const { return fixed_inertia_lost_; }
  [[nodiscard]] const std::vector<SiteEquality>& site_equalities() const { return sites_; }
  [[nodiscard]] std::string text() const;
  /// MuJoCo's message about the file as it was read.
  [[nodiscard]] MjcfSaid said(const std::string& message) const;
  /// `fullinertia` of every named body whose inertia the file gives, axes of the body.
  [[nodiscard]] std::map<std::string, Matrix3<double>> full_inertia() const;

 private:
  using Element = tinyxml2::XMLElement;
  void include(Element* at, const std::string& folder, int depth);
  [[nodiscard]] std::string path_of(const char* kind, const std::string& file) const;
  void strip_assets(Element* assets);
  void strip_uses(Element* e, bool moves, bool depends);

  std::string file_, folder_;
  tinyxml2::XMLDocument doc_;
  std::map<std::string, std::map<std::string, bool>> gone_;  ///< kind of asset → names
  std::vector<std::string> left_out_;
  std::vector<SiteEquality> sites_;
  bool included_ = false, by_geoms_ = false, fixed_inertia_lost_ = false;
};

}  // namespace delassus
