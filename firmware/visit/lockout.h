/* Who fails again and again is not looked at for a while: pure, time comes as an argument.
 *
 *   OPEN      a failure, when it is number `failures` since the last admission  -> LOCKED
 *             an attack, when it is number `attacks` since the last lock        -> LOCKED
 *             an admission                     -> OPEN, failures are forgotten, attacks are not
 *             forget_ns without either         -> OPEN, all is forgotten, also how long locks were
 *   LOCKED    the time of the lock is over     -> OPEN, counting begins anew
 *             clear                            -> OPEN, all is forgotten
 *
 * The first lock lasts first_ns, each later one twice as long as the one before, to longest_ns.
 * While it lasts nobody is let in, whoever it is, and nobody is told whether a face is known: the
 * search does not take place. What happens before the sensor meanwhile is not counted, so that who
 * waits is not punished for it.
 *
 * LOCKDOWN stands beside all this: nobody is let in until an administrator ends it.
 *
 * The lock is the door's, not a person's: who is refused has no name. Whoever wants to can thereby
 * keep others out for longest_ns at a time, by failing before the door again and again; the exit
 * button and keys are not touched by it. */
#ifndef ISO_FIRMWARE_VISIT_LOCKOUT_H
#define ISO_FIRMWARE_VISIT_LOCKOUT_H

#include <stdbool.h>
#include <stdint.h>

#include "firmware/visit/decision.h"

struct iso_lockout_options {
    int failures, attacks;        /* 0: they never lock */
    int64_t first_ns, longest_ns; /* 1 <= first_ns <= longest_ns */
    int64_t forget_ns;            /* 1 or more */
};

/* What outlasts a restart. Times are lengths, as no clock can be trusted to go on meanwhile: a lock
 * that a restart interrupts begins anew with what was left of it when this was written down. */
struct iso_lockout_record {
    int failures, attacks, locks;
    int64_t remaining_ns; /* of the lock; 0: OPEN */
    bool lockdown;
};

struct iso_lockout {
    struct iso_lockout_options options;
    int failures, attacks; /* counted so far */
    int locks;             /* in a row: how often the length has doubled */
    int64_t until_ns;      /* LOCKED until then; ISO_NEVER_NS: OPEN */
    int64_t last_ns;       /* of the last failure or attack, or the end of a lock */
    bool lockdown;
};

/* OPEN, and nothing has happened. */
void iso_lockout_init(struct iso_lockout *lockout, const struct iso_lockout_options *options);

/* As it was when the record was taken; numbers out of range are taken for the worst in it. */
void iso_lockout_restore(struct iso_lockout *lockout, const struct iso_lockout_record *record,
                         int64_t now_ns);
struct iso_lockout_record iso_lockout_record_of(const struct iso_lockout *lockout, int64_t now_ns);

/* Takes a verdict in that was given in OPEN; of those that stand for a failure (iso_lockout_counts)
 * and of admissions. True: it has locked the door. iso_lockout_time with its now_ns comes first. */
bool iso_lockout_verdict(struct iso_lockout *lockout, const struct iso_verdict *verdict, int agree,
                         int64_t now_ns);

/* Whether a verdict counts: an attack, or somebody who could have been recognised and was not. Who
 * left after fewer than `agree` frames could not; who is known but comes at the wrong time is no
 * stranger. */
bool iso_lockout_counts(const struct iso_verdict *verdict, int agree);

/* Takes in that it is now_ns. True if something has changed: a lock is over, or all is forgotten.
 */
bool iso_lockout_time(struct iso_lockout *lockout, int64_t now_ns);

/* When iso_lockout_time will do something; ISO_NEVER_NS if nothing is due. */
int64_t iso_lockout_due_ns(const struct iso_lockout *lockout);

/* An administrator ends a lock, and has all failures forgotten. A lockdown stays. */
void iso_lockout_clear(struct iso_lockout *lockout);

/* Why nobody is let in: ISO_REASON_LOCKDOWN, ISO_REASON_LOCKED_OUT, or ISO_REASON_NONE. */
enum iso_reason iso_lockout_refusal(const struct iso_lockout *lockout);

/* How long the lock still lasts; 0 in OPEN. */
int64_t iso_lockout_remaining_ns(const struct iso_lockout *lockout, int64_t now_ns);

#endif
