#include "bench/json.h"
#include "bench/peers/peer_table.h"

namespace delassus::bench {

using nlohmann::json;

namespace {

json written(const PeerEntry& e) {
  json j = {{"name", e.name}, {"program", e.program}, {"what", e.what}, {"counterparts", {{"product", e.product}, {"solve", e.solve}}}, {"from_q", e.from_q},
            {"cannot", e.cannot}, {"disagrees", e.disagrees}, {"loses_digits", e.loses_digits}, {"M_error", number(e.M_error)}, {"product_error", number(e.product_error)}, {"force_error", number(e.force_error)},
            {"microseconds", json::object()}};
  for (std::size_t k = 0; k < step_count; ++k)
    if (e.time[k].measured()) j["microseconds"][name(step(k))] = written(e.time[k]);
  return j;
}

PeerEntry peer_entry_read(const json& j) {
  PeerEntry e;
  e.name = j.at("name"), e.program = j.at("program"), e.what = j.at("what");
  e.product = j.at("counterparts").at("product"), e.solve = j.at("counterparts").at("solve");
  e.from_q = j.at("from_q");
  e.cannot = j.at("cannot"), e.disagrees = j.at("disagrees");
  e.loses_digits = j.value("loses_digits", false);  // of files older than it
  e.M_error = number_of(j.at("M_error")), e.product_error = number_of(j.at("product_error")), e.force_error = number_of(j.at("force_error"));
  for (std::size_t k = 0; k < step_count; ++k)
    if (const json& times = j.at("microseconds"); times.contains(name(step(k)))) e.time[k] = spread_read(times.at(name(step(k))));
  return e;
}

json written(const PeerScene& s) {
  json j = {{"scene", s.scene}, {"dof", s.dofs}, {"rows", s.rows}, {"loops", s.loops}, {"damping", {{"smallest", s.smallest_damping}, {"largest", s.largest_damping}}},
            {"limits", {{"product_error", number(s.product_limit)}, {"force_error", number(s.force_limit)}}}, {"entries", json::array()}};
  for (const PeerEntry& e : s.entries) j["entries"].push_back(written(e));
  return j;
}

PeerScene scene_read(const json& j) {
  PeerScene s{j.at("scene"), j.at("dof"), j.at("rows"), j.at("loops"), j.at("damping").at("smallest"), j.at("damping").at("largest"), number_of(j.at("limits").at("product_error")), number_of(j.at("limits").at("force_error")), {}};
  for (const json& e : j.at("entries")) s.entries.push_back(peer_entry_read(e));
  return s;
}

}  // namespace

void to_json(json& j, const PeerTable& t) {
  j = {{"units", {{"time", "µs per call"}, {"damping", "1/kg"}}}, {"peers", json::array()}};
  write(j, t);
  for (const PeerScene& s : t.scenes) j["peers"].push_back(written(s));
}

void from_json(const json& j, PeerTable& t) {
  read(j, t);
  t.scenes.clear();
  for (const json& s : j.at("peers")) t.scenes.push_back(scene_read(s));
}

}  // namespace delassus::bench
