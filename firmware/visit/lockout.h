/* After repeated failures and attacks, the door locks everybody out for a while. Pure: time is an
 * argument.
 *
 *   OPEN      a failure, when it is number `failures` since the last admission  -> LOCKED
 *             an attack, when it is number `attacks` since the last lock        -> LOCKED
 *             an admission                     -> OPEN, failures are forgotten, attacks are not
 *             forget_ns without either         -> OPEN, all is forgotten, also how long locks were
 *   LOCKED    the time of the lock is over     -> OPEN, counting begins anew
 *             clear                            -> OPEN, all is forgotten
 *
 * The first lock lasts first_ns, each later one twice as long as the one before, to longest_ns.
 * While it lasts nobody at all is let in, and nobody learns whether a face is known, because no
 * search takes place. Failures during a lock are not counted, so that waiting people do not make
 * it longer.
 *
 * LOCKDOWN is independent of these states: nobody is let in until an administrator ends it.
 *
 * The lock concerns the door, not one person, because a person who is refused is not known. So
 * anybody can keep others out for longest_ns at a time, by failing again and again. The exit
 * button and mechanical keys work all the same. */
#ifndef ISO_FIRMWARE_VISIT_LOCKOUT_H
#define ISO_FIRMWARE_VISIT_LOCKOUT_H

#include <stdbool.h>
#include <stdint.h>

#include "firmware/visit/decision.h"

struct iso_lockout_options {
    int failures, attacks;        /* 0: this kind never locks the door */
    int64_t first_ns, longest_ns; /* 1 <= first_ns <= longest_ns */
    int64_t forget_ns;            /* 1 or more */
};

/* The state that is kept over a restart. Times are durations, because no clock is certain to
 * continue meanwhile. A lock that a restart interrupts continues with the time that was left when
 * the record was written. */
struct iso_lockout_record {
    int failures, attacks, locks;
    int64_t remaining_ns; /* of the lock; 0: OPEN */
    bool lockdown;
};

struct iso_lockout {
    struct iso_lockout_options options;
    int failures, attacks; /* number counted so far */
    int locks;             /* locks in a row, which is how often the duration has doubled */
    int64_t until_ns;      /* LOCKED until then; ISO_NEVER_NS: OPEN */
    int64_t last_ns;       /* time of the last failure or attack, or of the end of a lock */
    bool lockdown;
    bool guessed; /* a wrong card or PIN is among the failures: no admission resets them, because
                   * the one who guesses may be admitted with his own. Not kept over a restart */
};

/* Begins in OPEN, with nothing counted. */
void iso_lockout_init(struct iso_lockout *lockout, const struct iso_lockout_options *options);

/* Restores the state of a record. A number out of range becomes the strictest one in the range. */
void iso_lockout_restore(struct iso_lockout *lockout, const struct iso_lockout_record *record,
                         int64_t now_ns);

/* The record of the state at now_ns. */
struct iso_lockout_record iso_lockout_record_of(const struct iso_lockout *lockout, int64_t now_ns);

/* Handles a verdict that was given in OPEN. Only failures (iso_lockout_counts) and admissions have
 * an effect. Returns true if it locks the door. Call iso_lockout_time with the same now_ns
 * before. */
bool iso_lockout_verdict(struct iso_lockout *lockout, const struct iso_verdict *verdict, int agree,
                         int64_t now_ns);

/* Whether a verdict counts as a failure: an attack, or a person who could have been recognised and
 * was not. A person who left after fewer than `agree` frames could not have been recognised; a
 * known person who comes at the wrong time is no stranger. Neither counts. */
bool iso_lockout_counts(const struct iso_verdict *verdict, int agree);

/* Does what is due at now_ns. Returns true if something has changed: a lock is over, or all
 * failures are forgotten. */
bool iso_lockout_time(struct iso_lockout *lockout, int64_t now_ns);

/* The time at which iso_lockout_time will have an effect; ISO_NEVER_NS if nothing is due. */
int64_t iso_lockout_due_ns(const struct iso_lockout *lockout);

/* An administrator ends the lock and clears all failures. A lockdown stays. */
void iso_lockout_clear(struct iso_lockout *lockout);

/* The reason why nobody is let in: ISO_REASON_LOCKDOWN, ISO_REASON_LOCKED_OUT, or
 * ISO_REASON_NONE. */
enum iso_reason iso_lockout_refusal(const struct iso_lockout *lockout);

/* How long the lock still lasts; 0 in OPEN. */
int64_t iso_lockout_remaining_ns(const struct iso_lockout *lockout, int64_t now_ns);

#endif
