/* What is left in memory of a person who was removed. */
#include <string.h>

#include "firmware/appliance/appliance_state.h"

/* The last visit's text ends before the name. */
static void forget_outcome(struct iso_appliance *appliance, const char *name)
{
    if (*name && strcmp(appliance->outcome_person, name) == 0) {
        const size_t verdict = strcspn(appliance->last_outcome, " ");
        explicit_bzero(appliance->last_outcome + verdict, sizeof appliance->last_outcome - verdict);
        explicit_bzero(appliance->outcome_person, sizeof appliance->outcome_person);
    }
}

void iso__appliance_forget(struct iso_appliance *appliance, const char *name)
{
    const struct iso_pipeline *pipeline = &appliance->borrowed.pipeline;
    const bool idle = appliance->mode == ISO_APPLIANCE_WATCH ||
                      appliance->mode == ISO_APPLIANCE_CLAIMED;
    forget_outcome(appliance, name);
    if (idle) { /* else somebody is looked at now, for whom these are */
        explicit_bzero(&appliance->person, sizeof appliance->person);
        iso_enrolment_wipe(&appliance->enrolment);
    }
    if (pipeline->ops->forget) {
        pipeline->ops->forget(pipeline->self);
    }
}
