#include "tests/firmware/audit/slow_disk_story.h"

#include <pthread.h>
#include <stdatomic.h>
#include <string.h>
#include <time.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/audit/journal.h"
#include "tests/firmware/audit/slow_disk_rig.h"
#include "tests/firmware/rigs/stores.h"
#include "tests/support/devices/wired_door.h"
#include "tests/support/disk/slow_disk.h"

/* ---- a contact that chatters ---- */

enum { DISK_MS = 20, CHATTER_HZ = 200, RECORDS_MAX = 60 };

static atomic_bool chatters;

/* Opens and closes the contact CHATTER_HZ times a second. */
static void *chatter(void *context)
{
    const struct timespec half = {.tv_nsec = 1000000000L / (2 * CHATTER_HZ)};
    (void)context;
    while (chatters) {
        wired_door_set(ISO_DOOR_CONTACT, true);
        (void)nanosleep(&half, NULL);
        wired_door_set(ISO_DOOR_CONTACT, false);
        (void)nanosleep(&half, NULL);
    }
    return NULL;
}

/* The visit waits for the record of the grant, but no longer than 250 ms. */
void a_chattering_contact_keeps_nobody_out(void **state)
{
    struct rig *rig = *state;
    pthread_t thread;
    int admitted = 0;
    slow_disk_rig_start(rig);
    const uint64_t before = iso_audit_writer_last(iso_appliance_log(rig->appliance));
    slow_disk_take_ms(DISK_MS);
    chatters = true;
    assert_int_equal(pthread_create(&thread, NULL, chatter, NULL), 0);
    wired_door_await(ISO_DOOR_BUZZER, 2 * CHATTER_HZ); /* the contact has chattered for a while */
    for (int i = 0; i < SLOW_DISK_RIG_VISITS_MAX && admitted < 3; i++) {
        admitted += strstr(slow_disk_rig_visit(rig), "visit allow anna match 2") != NULL;
    }
    chatters = false;
    assert_int_equal(pthread_join(thread, NULL), 0);
    slow_disk_take_ms(0);
    assert_int_equal(admitted, 3);
    iso_appliance_stop(rig->appliance);
    assert_string_equal(slow_disk_rig_record(rig, "records-lost"), "");
    const uint64_t last = iso_audit_writer_last(iso_appliance_log(rig->appliance));
    assert_in_range(last - before, 1, RECORDS_MAX);
}

/* ---- a journal that hangs ---- */

static struct {
    pthread_mutex_t mutex;
    pthread_cond_t changed;
    bool stuck;
} journal = {.mutex = PTHREAD_MUTEX_INITIALIZER, .changed = PTHREAD_COND_INITIALIZER};

static int send_when_it_works(const struct iovec *fields, int n)
{
    (void)fields;
    (void)n;
    (void)pthread_mutex_lock(&journal.mutex);
    while (journal.stuck) {
        (void)pthread_cond_wait(&journal.changed, &journal.mutex);
    }
    (void)pthread_mutex_unlock(&journal.mutex);
    return 0;
}

static void let_journal_work(void)
{
    (void)pthread_mutex_lock(&journal.mutex);
    journal.stuck = false;
    (void)pthread_cond_broadcast(&journal.changed);
    (void)pthread_mutex_unlock(&journal.mutex);
}

/* Opens the log of the rig with this journal. */
static void open_told_log(struct rig *rig, struct iso_journal *to)
{
    struct iso_audit_options audit = stores_audit(rig->directory);
    audit.written = iso_journal_record;
    audit.context = to;
    iso_appliance_free(rig->appliance);
    iso_audit_close(rig->audit);
    assert_int_equal(iso_audit_open(&audit, &rig->borrowed.times, &rig->audit, NULL), 0);
    rig->borrowed.audit = rig->audit;
    assert_int_equal(iso_appliance_new(&rig->borrowed, &rig->appliance), 0);
}

void a_stuck_journal_keeps_nobody_out(void **state)
{
    struct rig *rig = *state;
    struct iso_journal *to = NULL;
    const char *news = "";
    journal.stuck = true;
    assert_int_equal(iso_journal_new(send_when_it_works, &to), 0);
    open_told_log(rig, to);
    slow_disk_rig_start(rig);
    for (int i = 0; i < SLOW_DISK_RIG_VISITS_MAX && !strstr(news, "visit allow anna match 2");
         i++) {
        news = slow_disk_rig_visit(
            rig); /* again if the machine woke the log's thread only after 250 ms */
    }
    assert_true(journal.stuck);
    assert_non_null(strstr(news, "visit allow anna match 2"));
    let_journal_work();
    iso_appliance_stop(rig->appliance);
    slow_disk_rig_settle(rig);
    iso_journal_free(to);
    rig->audit = NULL;
    iso_appliance_free(rig->appliance);
    iso_audit_close(rig->borrowed.audit);
    rig->appliance = NULL;
}

/* ---- administration ---- */

void administration_does_not_keep_the_door_waiting(void **state)
{
    struct rig *rig = *state;
    pthread_t thread;
    void *result = NULL;
    slow_disk_rig_start(rig);
    slow_disk_hang();
    assert_int_equal(pthread_create(&thread, NULL, slow_disk_rig_remove_anna, rig), 0);
    slow_disk_await();
    for (unsigned press = 1; press <= 3; press++) {
        wired_door_press();
        wired_door_await(ISO_DOOR_RELAY, 2 * press);
    }
    assert_true(slow_disk_waiting() > 0);
    slow_disk_go_on();
    assert_int_equal(pthread_join(thread, &result), 0);
    assert_null(result);
}
