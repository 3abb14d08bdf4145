#include "thesis/register.h"

#include "campaign/campaign.h"
#include "thesis/check_contacts.h"
#include "thesis/check_coupling.h"
#include "thesis/check_load_step.h"
#include "thesis/check_pressure.h"
#include "thesis/check_suppression.h"
#include "thesis/pictures.h"
#include "thesis/suppression_subject.h"

namespace dynoproof {

void RegisterThesis(Registry&) {
  for (CheckKind kind : {MakeCheckKind<BoundedCheck>(), MakeCheckKind<ContactsCheck>(), MakeCheckKind<CouplingCheck>(),
                         MakeCheckKind<DivergenceCheck>(), MakeCheckKind<GrowthCheck>(), MakeCheckKind<LoadStepCheck>(),
                         MakeCheckKind<PlacementsCheck>(), MakeCheckKind<RampsCheck>(), MakeCheckKind<WanderCheck>()}) {
    AddCheckKind(std::move(kind));
  }
  AddPictureMaker(AddCouplings);
  AddPictureMaker(AddLoop);
  campaign::AddStudy("suppression", campaign::MakeSuppressionSubject);
}

}  // namespace dynoproof
