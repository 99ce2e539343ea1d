#include "enroll/web/first_code.h"

#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

#include "enroll/web/account/account.h"
#include "enroll/web/account/setup_code.h"
#include "enroll/web/published.h"

static const uint64_t every_us = UINT64_C(2000000);

struct web_first_code {
    struct web_first_code_setup setup;
    sd_event_source *timer;
    int64_t begun_s;                /* by up_s() */
    bool is_over;                   /* too long after the start: no code any more */
    bool has_failed;                /* the last code could not be stored */
    char code[WEB_SETUP_CODE_SIZE]; /* that was made last; "": none */
};

static int64_t clock_s(void)
{
    return time(NULL);
}

static int64_t boot_s(void)
{
    struct timespec now = {.tv_sec = 0};

    (void)clock_gettime(CLOCK_BOOTTIME, &now);
    return now.tv_sec;
}

static void withdraw(struct web_first_code *first)
{
    if (*first->code) {
        sodium_memzero(first->code, sizeof first->code);
        web_published_remove_code();
    }
}

/* A code that cannot be stored is tried again at the next look. */
static void make(struct web_first_code *first, int64_t now_s)
{
    struct iso_fault fault = {.text = ""};

    if (web_setup_code_make(first->setup.code_path, now_s, first->code, &fault)) {
        first->code[0] = '\0';
        if (!first->has_failed) {
            fprintf(stderr, "isotherm-web: no code for the first account: %s\n", fault.text);
        }
        first->has_failed = true;
        return;
    }
    first->has_failed = false;
    fprintf(stderr,
            "isotherm-web: the code for the first account, valid until an hour after the start: "
            "%s\n",
            first->code);
    web_published_write_code(first->code);
}

static void look_at_code(struct web_first_code *first)
{
    const int64_t now_s = first->setup.now_s();
    const char *path = first->setup.code_path;

    if (*first->code && web_setup_code_is(path, now_s, first->code)) {
        return;
    }
    /* The stored code is not ours. If we have made one since the start, root has replaced it, and
     * root's stays. Otherwise it is from before the start, and its text is lost. */
    const bool is_of_root = *first->code && web_setup_code_waits(path, now_s);
    if (is_of_root) {
        web_published_remove_code();
    } else {
        make(first, now_s);
    }
}

/* Nobody has made an account within an hour: our code ends, and a restart makes the next one. */
static void end(struct web_first_code *first)
{
    first->is_over = true;
    if (*first->code &&
        web_setup_code_is(first->setup.code_path, first->setup.now_s(), first->code)) {
        (void)unlink(first->setup.code_path);
    }
    withdraw(first);
    fprintf(stderr,
            "isotherm-web: nobody has made the first account within an hour of the start; a "
            "restart makes another code\n");
}

static int look(struct web_first_code *first)
{
    if (web_accounts_count(first->setup.accounts) > 0) {
        withdraw(first);
        if (access(first->setup.accounts_path, F_OK) < 0 && errno == ENOENT) {
            fprintf(stderr, "isotherm-web: the accounts were removed, as by a factory reset: the "
                            "server starts anew\n");
            return sd_event_exit(first->setup.event, -ESTALE);
        }
    } else if (first->setup.makes_codes && !first->is_over) {
        if (first->setup.up_s() - first->begun_s < WEB_FIRST_CODE_HELD_S) {
            look_at_code(first);
        } else {
            end(first);
        }
    }
    return 0;
}

static int on_timer(sd_event_source *source, uint64_t usec, void *context)
{
    struct web_first_code *first = context;
    int r = look(first);

    (void)usec;
    r = r < 0 ? r : sd_event_source_set_time_relative(source, first->setup.every_us);
    return r < 0 ? r : sd_event_source_set_enabled(source, SD_EVENT_ONESHOT);
}

int web_first_code_new(const struct web_first_code_setup *setup, struct web_first_code **out)
{
    struct web_first_code *first = calloc(1, sizeof *first);

    if (!first) {
        return -ENOMEM;
    }
    first->setup = *setup;
    first->setup.now_s = setup->now_s ? setup->now_s : clock_s;
    first->setup.up_s = setup->up_s ? setup->up_s : boot_s;
    first->begun_s = first->setup.up_s();
    first->setup.every_us = setup->every_us ? setup->every_us : every_us;
    const int r = sd_event_add_time_relative(setup->event, &first->timer, CLOCK_MONOTONIC, 0,
                                             first->setup.every_us / 4, on_timer, first);
    if (r < 0) {
        free(first);
        return r;
    }
    *out = first;
    return 0;
}

void web_first_code_free(struct web_first_code *first)
{
    if (first) {
        withdraw(first);
        sd_event_source_disable_unref(first->timer);
        free(first);
    }
}
