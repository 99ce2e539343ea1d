#include "firmware/visit/lockout.h"

#include "drivers/base/times.h"

/* The duration of a lock reaches its limit long before this number of locks. */
enum { LOCKS_MAX = 40, COUNT_MAX = 1000000 };

static bool is_locked(const struct iso_lockout *lockout)
{
    return lockout->until_ns != ISO_NEVER_NS;
}

static void forget(struct iso_lockout *lockout)
{
    lockout->guessed = false;
    lockout->failures = 0;
    lockout->attacks = 0;
    lockout->locks = 0;
    lockout->until_ns = ISO_NEVER_NS;
}

void iso_lockout_init(struct iso_lockout *lockout, const struct iso_lockout_options *options)
{
    *lockout = (struct iso_lockout){.options = *options};
    forget(lockout);
}

/* The duration of a lock that follows so many others. */
static int64_t length_ns(const struct iso_lockout_options *options, int locks)
{
    int64_t length = options->first_ns;
    for (int i = 0; i < locks && length < options->longest_ns; i++) {
        length = length <= options->longest_ns / 2 ? 2 * length : options->longest_ns;
    }
    return length;
}

static int within(int value, int max)
{
    return value < 0 || value > max ? max : value;
}

void iso_lockout_restore(struct iso_lockout *lockout, const struct iso_lockout_record *record,
                         int64_t now_ns)
{
    const int64_t longest_ns = lockout->options.longest_ns;
    const bool odd = record->remaining_ns < 0 || record->remaining_ns > longest_ns;
    forget(lockout);
    lockout->failures = within(record->failures, COUNT_MAX);
    lockout->attacks = within(record->attacks, COUNT_MAX);
    lockout->locks = within(record->locks, LOCKS_MAX);
    lockout->lockdown = record->lockdown;
    lockout->last_ns = now_ns;
    if (record->remaining_ns != 0) {
        lockout->until_ns = now_ns + (odd ? longest_ns : record->remaining_ns);
    }
}

struct iso_lockout_record iso_lockout_record_of(const struct iso_lockout *lockout, int64_t now_ns)
{
    return (struct iso_lockout_record){
        .failures = lockout->failures,
        .attacks = lockout->attacks,
        .locks = lockout->locks,
        .remaining_ns = iso_lockout_remaining_ns(lockout, now_ns),
        .lockdown = lockout->lockdown,
    };
}

bool iso_lockout_counts(const struct iso_verdict *verdict, int agree)
{
    switch (verdict->reason) {
    case ISO_REASON_UNKNOWN:
    case ISO_REASON_ATTACK:
    case ISO_REASON_WRONG_FACTOR: /* PINs can be guessed */
        return true;
    case ISO_REASON_LEFT:
        return verdict->frames >= agree;
    default:
        return false;
    }
}

static bool reached(int count, int limit)
{
    return limit > 0 && count >= limit;
}

bool iso_lockout_verdict(struct iso_lockout *lockout, const struct iso_verdict *verdict, int agree,
                         int64_t now_ns)
{
    const struct iso_lockout_options *options = &lockout->options;
    if (is_locked(lockout)) {
        return false;
    }
    if (verdict->allow && verdict->reason != ISO_REASON_OPEN && !lockout->guessed) {
        lockout->failures = 0;
    }
    lockout->guessed |= verdict->reason == ISO_REASON_WRONG_FACTOR;
    if (!iso_lockout_counts(verdict, agree)) {
        return false;
    }
    const bool attack = verdict->reason == ISO_REASON_ATTACK;
    lockout->attacks = within(lockout->attacks + attack, COUNT_MAX);
    lockout->failures = within(lockout->failures + !attack, COUNT_MAX);
    lockout->last_ns = now_ns;
    if (!reached(lockout->failures, options->failures) &&
        !reached(lockout->attacks, options->attacks)) {
        return false;
    }
    lockout->until_ns = now_ns + length_ns(options, lockout->locks);
    lockout->locks = within(lockout->locks + 1, LOCKS_MAX);
    return true;
}

int64_t iso_lockout_due_ns(const struct iso_lockout *lockout)
{
    if (is_locked(lockout)) {
        return lockout->until_ns;
    }
    const bool remembers = lockout->failures > 0 || lockout->attacks > 0 || lockout->locks > 0;
    return remembers ? lockout->last_ns + lockout->options.forget_ns : ISO_NEVER_NS;
}

bool iso_lockout_time(struct iso_lockout *lockout, int64_t now_ns)
{
    if (now_ns < iso_lockout_due_ns(lockout)) {
        return false;
    }
    if (is_locked(lockout)) {
        lockout->last_ns = lockout->until_ns;
        lockout->until_ns = ISO_NEVER_NS;
        lockout->failures = 0;
        lockout->attacks = 0;
        lockout->guessed = false;
    } else {
        forget(lockout);
    }
    return true;
}

void iso_lockout_clear(struct iso_lockout *lockout)
{
    forget(lockout);
}

enum iso_reason iso_lockout_refusal(const struct iso_lockout *lockout)
{
    if (lockout->lockdown) {
        return ISO_REASON_LOCKDOWN;
    }
    return is_locked(lockout) ? ISO_REASON_LOCKED_OUT : ISO_REASON_NONE;
}

int64_t iso_lockout_remaining_ns(const struct iso_lockout *lockout, int64_t now_ns)
{
    if (!is_locked(lockout)) {
        return 0;
    }
    return lockout->until_ns > now_ns ? lockout->until_ns - now_ns : 1;
}
