#include "thesis/register.h"

#include "campaign/campaign.h"
#include "thesis/check_contacts.h"
#include "thesis/check_coupling.h"
#include "thesis/check_filters.h"
#include "thesis/check_load_step.h"
#include "thesis/check_pressure.h"
#include "thesis/check_suppression.h"
#include "thesis/machine_subject.h"
#include "thesis/pictures_coupling.h"
#include "thesis/pictures_loop.h"
#include "thesis/study_subject.h"
#include "thesis/suppression_subject.h"

namespace dynoproof {

void RegisterThesis(Registry& registry) {
  registry.AddCheck<BoundedCheck>();
  registry.AddCheck<ContactsCheck>();
  registry.AddCheck<CouplingCheck>();
  registry.AddCheck<DivergenceCheck>();
  registry.AddCheck<FiltersHoldCheck>();
  registry.AddCheck<GrowthCheck>();
  registry.AddCheck<LoadStepCheck>();
  registry.AddCheck<OscillationCheck>();
  registry.AddCheck<PlacementsCheck>();
  registry.AddCheck<RampsCheck>();
  registry.AddCheck<WanderCheck>();
  AddPictureMaker(AddCouplings);
  AddPictureMaker(AddLoop);
  campaign::AddStudy("machine", campaign::MakeStudySubject<campaign::MachineStudy>);
  campaign::AddStudy("suppression", campaign::MakeStudySubject<campaign::SuppressionStudy>);
}

}  // namespace dynoproof
