#include "enroll/web/login/turns.h"

#include <errno.h>
#include <stdlib.h>
#include <sys/queue.h>
#include <time.h>

struct turn {
    STAILQ_ENTRY(turn) link;
    struct web_exchange *exchange;
    void (*go)(struct web_login *login, struct web_exchange *exchange);
};

struct web_turns {
    struct web_login *login;
    sd_event_source *next;
    STAILQ_HEAD(, turn) waiting;
};

/* Takes the first one out. NULL: nobody waits. */
static struct turn *take(struct web_turns *turns)
{
    struct turn *turn = STAILQ_FIRST(&turns->waiting);

    if (turn) {
        STAILQ_REMOVE_HEAD(&turns->waiting, link);
    }
    return turn;
}

/* A time that has come joins the end of what is due. (A deferred source would always be the first.)
 */
static int soon(sd_event_source *source)
{
    const int r = sd_event_source_set_time_relative(source, 0);

    return r < 0 ? r : sd_event_source_set_enabled(source, SD_EVENT_ONESHOT);
}

static int on_next(sd_event_source *source, uint64_t usec, void *context)
{
    struct web_turns *turns = context;
    struct turn *turn = take(turns);
    (void)usec;

    if (turn) {
        turn->go(turns->login, turn->exchange);
        free(turn);
    }
    return STAILQ_EMPTY(&turns->waiting) ? 0 : soon(source);
}

int web_turns_new(sd_event *event, struct web_login *login, struct web_turns **out)
{
    struct web_turns *turns = calloc(1, sizeof *turns);

    if (!turns) {
        return -ENOMEM;
    }
    turns->login = login;
    STAILQ_INIT(&turns->waiting);
    int r = sd_event_add_time_relative(event, &turns->next, CLOCK_MONOTONIC, 0, 1, on_next, turns);
    r = r < 0 ? r : sd_event_source_set_enabled(turns->next, SD_EVENT_OFF);
    if (r < 0) {
        web_turns_free(turns);
        return r;
    }
    *out = turns;
    return 0;
}

static void refuse(struct web_exchange *exchange)
{
    web_exchange_problem(exchange, 503, "busy", "the web server ends, or has no memory for this");
}

void web_turns_free(struct web_turns *turns)
{
    if (turns) {
        for (struct turn *turn = take(turns); turn; turn = take(turns)) {
            refuse(turn->exchange);
            free(turn);
        }
        sd_event_source_disable_unref(turns->next);
        free(turns);
    }
}

void web_turns_wait(struct web_turns *turns, struct web_exchange *exchange,
                    void (*go)(struct web_login *login, struct web_exchange *exchange))
{
    struct turn *turn = malloc(sizeof *turn);

    if (!turn) {
        refuse(exchange);
        return;
    }
    *turn = (struct turn){.exchange = exchange, .go = go};
    STAILQ_INSERT_TAIL(&turns->waiting, turn, link);
    (void)soon(turns->next);
}
