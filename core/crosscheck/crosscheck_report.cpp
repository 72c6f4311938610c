#include "core/crosscheck/crosscheck_report.h"

#include <fmt/format.h>

#include <cmath>

#include "core/base/text.h"
#include "core/shared/vector.h"

namespace sightline {
namespace {

/// Answers of each device that the table shows in full; the JSON has them all.
constexpr size_t kShownRays = 3;

Json verdictCounts(const std::array<uint64_t, kVerdicts>& counts) {
  Json json;
  for (const Verdict verdict : kAllVerdicts) json[verdictName(verdict)] = counts[size_t(verdict)];
  return json;
}

/// Differences in glass are of scenes with glass alone.
uint32_t differencesOf(const CrosscheckReport& report) {
  return report.glass ? kDifferences : uint32_t(Difference::kGlass);
}

Json differenceCounts(const std::array<uint64_t, kDifferences>& counts, uint32_t kinds) {
  Json json;
  for (uint32_t i = 0; i < kinds; ++i) json[differenceName(Difference(i))] = counts[i];
  return json;
}

Json toJson(const ErrorHistogram& ulps) {
  return {{"count", ulps.count()},        {"p50", ulps.percentile(0.5)},    {"p90", ulps.percentile(0.9)},
          {"p99", ulps.percentile(0.99)}, {"p999", ulps.percentile(0.999)}, {"max", ulps.max()}};
}

Json toJson(const KindReport& kind, const CrosscheckReport& report) {
  const std::vector<DeviceInfo>& devices = report.devices;
  Json json = {{"kind", rayKindName(kind.kind)},
               {"rays", kind.rays},
               {"disputed", kind.disputed},
               {"checked", kind.checked},
               {"devices", Json::array()}};
  for (size_t d = 0; d < devices.size(); ++d) {
    const DeviceTally& tally = kind.devices[d];
    json["devices"].push_back({{"device", devices[d].id},
                               {"hits", tally.hits},
                               {"differences", differenceCounts(tally.differences, differencesOf(report))},
                               {"disputed", verdictCounts(tally.disputed)},
                               {"checked", verdictCounts(tally.checked)},
                               {"rounded_steps_max", tally.steps_beside},
                               {"distance_ulps", toJson(tally.ulps)}});
    if (report.glass) json["devices"].back()["glass"] = tally.glass;
  }
  return json;
}

std::vector<std::string> idsOf(const std::vector<DeviceInfo>& devices) {
  std::vector<std::string> ids;
  for (const DeviceInfo& device : devices) ids.push_back(device.id);
  return ids;
}

Json toJson(const WorstRay& ray, const std::vector<DeviceInfo>& devices) {
  Json json = {{"device", devices[ray.device].id},
               {"measure", ray.measure},
               {"kind", rayKindName(ray.checked.kind)},
               {"cell", ray.checked.cell},
               {"number", ray.checked.number}};
  addAnswers(json, ray.checked.answers, idsOf(devices));
  return json;
}

std::string worstText(const WorstRay& ray, const std::vector<DeviceInfo>& devices) {
  const RayAnswers& answers = ray.checked.answers;
  std::string text =
      fmt::format("\n{}, {} ray {} of cell {}: {}\n", devices[ray.device].id, rayKindName(ray.checked.kind),
                  ray.checked.number, ray.checked.cell, verdictName(answers.rulings[ray.device].verdict));
  text += fmt::format("  from {} along {}\n  exactly: {}\n", hexText(xyz3(answers.ray.origin)),
                      hexText(xyz3(answers.ray.direction)), exactText(answers.exact, answers.exact_glass));
  for (size_t i = 0; i < devices.size(); ++i) {
    text += fmt::format("  {}: {} ({})\n", devices[i].id, answerText(answers.hits[i], answers.glass[i]),
                        verdictName(answers.rulings[i].verdict));
  }
  return text;
}

}  // namespace

std::vector<std::string> pastLimits(const CrosscheckReport& report, const CrosscheckLimits& limits) {
  std::vector<std::string> lines;
  for (size_t d = 0; d < report.devices.size(); ++d) {
    uint64_t counts[kVerdicts] = {}, differences = 0;
    double ulps = 0;
    for (const KindReport& kind : report.kinds) {
      const DeviceTally& tally = kind.devices[d];
      for (const Verdict verdict : kAllVerdicts) counts[size_t(verdict)] += tally.verdicts(verdict);
      for (uint32_t i = 1; i < kDifferences; ++i) differences += tally.differences[i];
      ulps = std::max(ulps, tally.ulps.max());
    }
    if (d < report.wrong_in_sets.size()) counts[size_t(Verdict::kWrong)] += report.wrong_in_sets[d];
    const auto check = [&](const auto& limit, auto value, const char* what) {
      if (!limit || value <= *limit) return;
      lines.push_back(
          fmt::format("{}: {} {}, at most {} allowed", report.devices[d].id, value, what, *limit));
    };
    check(limits.wrong, counts[size_t(Verdict::kWrong)], "wrong");
    check(limits.missed, counts[size_t(Verdict::kMissed)], "missed");
    check(limits.rounded, counts[size_t(Verdict::kRounded)], "rounded");
    check(limits.differences, differences, "differences from the first device");
    check(limits.ulps, ulps, "ulps off in distance");
  }
  return lines;
}

Json crosscheckJson(const CrosscheckHead& head, const CrosscheckReport& report) {
  Json devices = Json::array(), kinds = Json::array(), worst = Json::array();
  for (const DeviceInfo& device : report.devices) {
    devices.push_back(
        {{"id", device.id}, {"name", device.name}, {"driver", device.driver}, {"layout", device.layout}});
  }
  for (const KindReport& kind : report.kinds) kinds.push_back(toJson(kind, report));
  for (const WorstRay& ray : report.worst) worst.push_back(toJson(ray, report.devices));
  return {
      {"sightline", head.version},
      {"scene",
       {{"name", head.scene.name}, {"hash", hashText(head.scene.hash)}, {"triangles", head.scene.triangles}}},
      {"scale", head.scale},
      {"move", head.move},
      {"cells", head.cells},
      {"seed", head.options.seed},
      {"rays", head.options.rays},
      {"check_every", head.options.check_every},
      {"rounding_steps", head.options.rounding.steps},
      {"devices", devices},
      {"kinds", kinds},
      {"worst", worst},
      {"disagreements", {{"count", report.disagreements.count}, {"illegal", report.disagreements.illegal}}},
      {"trace_seconds", report.trace_seconds},
      {"judge_seconds", report.judge_seconds}};
}

std::string crosscheckTable(const CrosscheckReport& report) {
  size_t width = 6;
  for (const DeviceInfo& device : report.devices) width = std::max(width, device.id.size());
  std::string table = fmt::format(
      "{:<10}  {:>9}  {:<{}}  {:>8} {:>8} {:>8} {:>8}{}  {:>8} {:>8} {:>8} {:>8} {:>8}  {:>7} {:>8} {:>8}\n",
      "kind", "rays", "device", width, "tie", "edge", "one miss", "other", report.glass ? "    glass" : "",
      "judged", "right", "rounded", "missed", "wrong", "ulps 50", "99 %", "max");
  for (const KindReport& kind : report.kinds) {
    for (size_t d = 0; d < report.devices.size(); ++d) {
      const DeviceTally& t = kind.devices[d];
      table += fmt::format("{:<10}  {:>9}  {:<{}}  ", d == 0 ? rayKindName(kind.kind) : "",
                           d == 0 ? shortCount(kind.rays) : "", report.devices[d].id, width);
      for (uint32_t i = 1; i < differencesOf(report); ++i) table += fmt::format("{:>8} ", t.differences[i]);
      table += fmt::format(" {:>8} ", kind.disputed + kind.checked);
      for (const Verdict verdict : kAllVerdicts) table += fmt::format("{:>8} ", t.verdicts(verdict));
      table += fmt::format(" {:>7.2g} {:>8.3g} {:>8.3g}\n", t.ulps.percentile(0.5), t.ulps.percentile(0.99),
                           t.ulps.max());
    }
  }
  std::vector<size_t> shown(report.devices.size());
  for (const WorstRay& ray : report.worst) {
    if (ray.checked.answers.rulings[ray.device].verdict == Verdict::kRight ||
        shown[ray.device]++ >= kShownRays)
      continue;
    table += worstText(ray, report.devices);
  }
  return table;
}

}  // namespace sightline
