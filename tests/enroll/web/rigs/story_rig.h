/* An enrolment from its beginning to its end, with the stand-in of the daemon. */
#ifndef TEST_WEB_RIG_STORY_H
#define TEST_WEB_RIG_STORY_H

#include "tests/enroll/web/rigs/handler_rig.h"

/* The body of the request, and the calls of the daemon that it causes. */
#define RIG_REQUEST "{'person': 'Bo', 'consent': true}"
#define RIG_CALLS                                                         \
    "RecordAct ada consent Bo;RecordAct ada enroll Bo;Claim;WatchRelief;" \
    "EnrollStart Bo poses=1 allow-duplicate=0;"

/* An enrolment that runs, and the session that began it with its stream of events. */
struct rig_story {
    struct rig *rig;
    uint64_t session;
    struct web_exchange events;
};

/* Begins an enrolment; the trace of the service has to be empty. */
void rig_story_begin(struct rig_story *story, struct rig *rig);

/* Waits until the enrolment has ended with this result, closes the stream of events, and returns
 * the enrolment, which the caller releases. */
json_t *rig_story_end(struct rig_story *story, const char *result);

/* Whether no enrolment goes on. `rig` is a struct rig. */
bool rig_is_idle(void *rig);

/* Whether the last call of the daemon was Release. */
bool rig_has_released(const struct rig *rig);

/* The signals of the daemon during an enrolment. */
void rig_send_status(struct rig *rig, const char *result, bool done, unsigned stage, double quality,
                     const char *person);
void rig_send_step(struct rig *rig, const char *pose, const char *state, unsigned step,
                   double turn_deg);

#endif
