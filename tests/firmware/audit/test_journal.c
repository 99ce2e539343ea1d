/* The system's journal may hang. No thread waits for it, and entries that were not sent are
 * counted. */
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/audit/journal.h"

enum { MORE = 10 };

/* A journal that can hang. It keeps the entries that it received: "ISOTHERM_SEQUENCE=1;..." */
static struct {
    pthread_mutex_t mutex;
    pthread_cond_t changed;
    bool stuck;
    int waiting, sent;
    char text[65536];
} journal = {.mutex = PTHREAD_MUTEX_INITIALIZER, .changed = PTHREAD_COND_INITIALIZER};

static void keep(const struct iovec *field)
{
    static const char sequence[] = "ISOTHERM_SEQUENCE=", unsent[] = "ISOTHERM_UNSENT=";
    const size_t used = strlen(journal.text);
    if (strncmp(field->iov_base, sequence, sizeof sequence - 1) == 0 ||
        strncmp(field->iov_base, unsent, sizeof unsent - 1) == 0) {
        (void)snprintf(journal.text + used, sizeof journal.text - used, "%.*s;",
                       (int)field->iov_len, (const char *)field->iov_base);
    }
}

static int take(const struct iovec *fields, int n)
{
    (void)pthread_mutex_lock(&journal.mutex);
    journal.waiting++;
    (void)pthread_cond_broadcast(&journal.changed);
    while (journal.stuck) {
        (void)pthread_cond_wait(&journal.changed, &journal.mutex);
    }
    for (int i = 0; i < n; i++) {
        keep(&fields[i]);
    }
    journal.sent++;
    (void)pthread_cond_broadcast(&journal.changed);
    (void)pthread_mutex_unlock(&journal.mutex);
    return 0;
}

static void be_stuck(bool stuck)
{
    (void)pthread_mutex_lock(&journal.mutex);
    journal.stuck = stuck;
    (void)pthread_cond_broadcast(&journal.changed);
    (void)pthread_mutex_unlock(&journal.mutex);
}

/* Waits until the journal has begun to take `waiting` entries and has taken `sent` entries. */
static void await(int waiting, int sent)
{
    (void)pthread_mutex_lock(&journal.mutex);
    while (journal.waiting < waiting || journal.sent < sent) {
        (void)pthread_cond_wait(&journal.changed, &journal.mutex);
    }
    (void)pthread_mutex_unlock(&journal.mutex);
}

static int setup(void **state)
{
    struct iso_journal *new = NULL;
    journal.stuck = false;
    journal.waiting = journal.sent = 0;
    journal.text[0] = '\0';
    const int error = iso_journal_new(take, &new);
    *state = new;
    return error;
}

static void record(struct iso_journal *to, int n)
{
    const struct iso_audit_record one = iso_audit_record_of("x");
    static uint64_t sequence;
    for (int i = 0; i < n; i++) {
        sequence = strlen(journal.text) == 0 && i == 0 && journal.waiting == 0 ? 1 : sequence + 1;
        iso_journal_record(to, &one, sequence, "abc");
    }
}

/* ---- tests ---- */

static void entries_are_sent_in_order(void **state)
{
    record(*state, 3);
    iso_journal_free(*state); /* sends the queued entries */
    assert_string_equal(journal.text,
                        "ISOTHERM_SEQUENCE=1;ISOTHERM_SEQUENCE=2;ISOTHERM_SEQUENCE=3;");
}

/* This test would never end if a caller waited for the journal. */
static void nobody_waits_for_a_stuck_journal(void **state)
{
    char unsent[40];
    be_stuck(true);
    record(*state, 1);
    await(1, 0);
    record(*state, ISO_JOURNAL_ENTRIES + MORE);
    assert_int_equal(journal.sent, 0);
    be_stuck(false);
    await(1 + ISO_JOURNAL_ENTRIES, 1 + ISO_JOURNAL_ENTRIES);
    assert_null(strstr(journal.text, "UNSENT"));
    record(*state, 1);
    iso_journal_free(*state);
    assert_int_equal(journal.sent, 1 + ISO_JOURNAL_ENTRIES + 1);
    (void)snprintf(unsent, sizeof unsent, "ISOTHERM_UNSENT=%d;", MORE);
    assert_non_null(strstr(journal.text, unsent));
}

static void the_end_does_not_wait_for_a_stuck_journal(void **state)
{
    be_stuck(true);
    record(*state, 2);
    await(1, 0);
    iso_journal_free(*state);
    assert_int_equal(journal.sent, 0);
    be_stuck(false);
    await(1, 1); /* the thread continues and ends */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(entries_are_sent_in_order, setup),
        cmocka_unit_test_setup(nobody_waits_for_a_stuck_journal, setup),
        cmocka_unit_test_setup(the_end_does_not_wait_for_a_stuck_journal, setup),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
