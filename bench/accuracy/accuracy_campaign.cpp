#include "bench/accuracy/accuracy_campaign.h"

#include "bench/stopwatch.h"
#include "bench/text.h"
#include "generators/families.h"

namespace delassus::accuracy {

namespace {

constexpr double far_away = 1e6;  // [m]

/// Measures subjects one by one until the time is up.
class Walk {
 public:
  Walk(const CampaignOptions& o, Campaign& c, const std::function<void(const std::string&)>& progress)
      : options_(o), campaign_(c), progress_(progress) {}

  template <class Open> void step(std::vector<Table>& to, const std::string& what, const Options& options, Open&& open) {
    if (options.stop && options.stop()) return leave_out(what, "interrupted");
    if (bench::seconds_since(start_) > options_.seconds) return leave_out(what, "time was up");
    const Subject subject = open();
    if (subject.rows() == 0) return leave_out(what, "no rows");
    try {
      to.push_back(measure(subject, options_.rungs, options));
    } catch (const std::runtime_error& e) {
      return leave_out(what, e.what());
    }
    progress_(bench::format("accuracy  %4.0f s  ", bench::seconds_since(start_)) + what);
  }

 private:
  void leave_out(const std::string& what, const std::string& why) { campaign_.left_out.push_back(what + ": " + why); }

  const CampaignOptions& options_;
  Campaign& campaign_;
  const std::function<void(const std::string&)>& progress_;
  const std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace

Campaign run_campaign(const CampaignOptions& o, const std::function<void(const std::string&)>& progress) {
  Campaign c;
  Walk walk(o, c, progress);
  Options untimed = o.timed;
  untimed.budget = 0;
  untimed.dampings = {own_damping};
  if (o.with_families)
    for (const auto& family : generators::families())
      walk.step(c.families, std::string(family.name), untimed,
                [&] { return subject_of(family.name, middle_size(family.name), o.timed.seed, 0); });
  const std::vector<std::string> scenes = o.scenes.empty() ? scene_names() : o.scenes;
  for (const std::string& scene : scenes) walk.step(c.here, scene, o.timed, [&] { return subject_of(open_scene(scene), 0); });
  untimed.dampings = dampings_up_to(1e-2);
  if (o.with_away)
    for (const std::string& scene : scenes)
      walk.step(c.away, scene + ", 1000 km away", untimed, [&] { return subject_of(open_scene(scene), far_away); });
  return c;
}

}  // namespace delassus::accuracy
