#include <errno.h>

#include "firmware/fleet/link/link_inner.h"

enum {
    BETWEEN_S = 1,
    PERIOD_S = 60,
    PERIOD_ONLINE_S = 5, /* half of ISO_FLEET_LEASE_ONLINE_S */
    LEASE_PART = 8,
    ANSWER_S = 10,
    ANSWER_ONLINE_S = 3, /* so that a lost answer does not end the lease */
    ANSWER_MOST_S = 60,
    SHORTER_PART = 10,
};

/* With many doors the hub may need long, and each further question is more work for it, so the wait
 * doubles. */
static uint64_t wait_for_answer_us(const struct link_door *door)
{
    const uint32_t doublings = door->unanswered < 5 ? door->unanswered : 5;
    const uint64_t first = door->report.leases && door->status.lease_s == 0 ? ANSWER_ONLINE_S
                                                                            : ANSWER_S;
    const uint64_t wait_s = first << doublings;

    return (wait_s < ANSWER_MOST_S ? wait_s : ANSWER_MOST_S) * LINK_S_US;
}

uint64_t link_period_us(uint32_t lease_s, bool had_reason, uint64_t random)
{
    const uint64_t least = BETWEEN_S * LINK_S_US;
    uint64_t period = PERIOD_ONLINE_S * LINK_S_US;

    if (lease_s) {
        const uint64_t part = lease_s * LINK_S_US / LEASE_PART;
        period = part < PERIOD_S * LINK_S_US ? part : PERIOD_S * LINK_S_US;
    }
    if (period < least) {
        period = least;
    }
    const uint64_t shorter = had_reason ? period - period / SHORTER_PART : period / SHORTER_PART;
    period -= random % (shorter + 1);
    return period < least ? least : period;
}

void link_ask(struct link_door *door)
{
    const uint64_t now = link_now_us(door);
    const uint64_t earliest = door->asked_us ? door->asked_us + BETWEEN_S * LINK_S_US : 0;

    if (door->is_asking) {
        door->asks_again = true;
    } else if (door->has_daemon && door->is_subscribed) {
        door->has_reason = true;
        link_at(door, LINK_DUE_QUESTION, earliest > now ? earliest : now);
    }
}

void link_ask_now(struct link_door *door)
{
    struct iso_fleet_bytes question = {.bytes = NULL};
    struct iso_fault fault = {.text = ""};

    if (door->is_asking || !door->has_daemon || !door->is_subscribed) {
        return;
    }
    int r = door->daemon.question(door->daemon.context, &question, &fault);
    if (link_daemon_result(door, r, &fault) < 0) {
        return;
    }
    r = link_mqtt_publish(door->mqtt, door->topic_out, question.bytes, question.size, false, NULL);
    iso_fleet_bytes_free(&question);
    door->asked_us = link_now_us(door);
    if (r == 0) {
        door->is_asking = true;
        door->asks_again = false;
        door->report.questions++;
        link_in(door, LINK_DUE_ANSWER, wait_for_answer_us(door));
    } else if (r != -ENOTCONN) {
        link_ask(door);
    }
}

void link_ask_late(struct link_door *door)
{
    door->unanswered++;
    door->is_asking = false;
    link_ask(door);
}

void link_answered(struct link_door *door)
{
    const bool asks_again = door->asks_again;

    if (door->unanswered > 0) {
        link_requests_start(door); /* the hub was away, and may have lost them */
    }
    door->is_asking = false;
    door->asks_again = false;
    door->unanswered = 0;
    door->report.leases++;
    link_never(door, LINK_DUE_ANSWER);
    link_never(door, LINK_DUE_QUESTION);
    link_at(door, LINK_DUE_QUESTION,
            door->asked_us + link_period_us(door->status.lease_s, door->has_reason, link_random()));
    door->has_reason = false;
    if (asks_again) {
        link_ask(door);
    }
}
