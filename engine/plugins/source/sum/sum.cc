#include "plugins/source/sum/sum.h"

namespace dynoproof::sources {

PluginInfo Sum::Info() { return {"source", "sum", "the sum of other sources", "sum of the sources", "definition", {}}; }

std::unique_ptr<Sum> Sum::Create(const Params& params, const dynoproof::Value& table, BuildContext& context) {
  constexpr std::uint64_t kSummandStream = 3;
  if (params.sources.empty()) {
    Faults(table, context.diagnostics, context.context).At("sources", "there is nothing to sum", "at least one source");
    return nullptr;
  }
  auto sum = std::make_unique<Sum>();
  bool good = true;
  for (std::size_t i = 0; i < params.sources.size(); ++i) {
    BuildContext one = context;
    one.context = fmt::format("{}.sources[{}]", context.context, i);
    one.known.clear();
    one.seed = static_cast<std::int64_t>(RandomBits(static_cast<std::uint64_t>(context.seed), kSummandStream, i));
    sum->sources_.push_back(context.registry.MakeComponent("source", params.sources[i], one));
    good = good && sum->sources_.back() != nullptr;
  }
  return good ? std::move(sum) : nullptr;
}

double Sum::Value(double time_s) const {
  double sum = 0.0, one = 0.0;
  for (const std::unique_ptr<Component>& source : sources_) {
    source->Output({time_s, {}, {}, {}}, {&one, 1});
    sum += one;
  }
  return sum;
}

}  // namespace dynoproof::sources
