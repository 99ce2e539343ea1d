/* People are transferred from one gallery to another, with a passphrase or for an address. Changed
 * files and wrong keys are refused. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/transfer/transfer.h"
#include "tests/firmware/rigs/puppets.h"
#include "tests/support/scratch.h"

/* One of the two doors. */
struct door {
    struct iso_key_ring *ring;
    struct iso_gallery *gallery;
    char address[ISO_TRANSFER_ADDRESS_SIZE];
};

struct doors {
    void *directory;
    struct door here, there;
    struct iso_transfer_lock lock; /* of a passphrase */
};

static void open_door(const char *directory, const char *name, struct door *out)
{
    char path[3][64];
    (void)snprintf(path[0], sizeof path[0], "%s.db", name);
    (void)snprintf(path[1], sizeof path[1], "%s.keys", name);
    (void)snprintf(path[2], sizeof path[2], "%s.key", name);
    const struct iso_key_place place = {.ring = scratch_path(directory, path[1]),
                                        .file = scratch_path(directory, path[2])};
    assert_int_equal(iso_key_ring_open(&place, &out->ring, NULL), 0);
    const struct iso_gallery_options options = {.path = scratch_path(directory, path[0]),
                                                .capacity = 3,
                                                .algorithm = PUPPET_ALGORITHM,
                                                .ring = out->ring};
    assert_int_equal(iso_gallery_open(&options, &out->gallery, NULL), 0);
    iso_transfer_address(out->ring, out->address);
}

static int setup(void **state)
{
    struct doors *doors = calloc(1, sizeof *doors);
    if (!doors || scratch_setup(&doors->directory)) {
        return -1;
    }
    open_door(doors->directory, "here", &doors->here);
    open_door(doors->directory, "there", &doors->there);
    memset(&doors->lock.key, 0x3c, sizeof doors->lock.key);
    *state = doors;
    return 0;
}

static void close_door(struct door *door)
{
    iso_gallery_close(door->gallery);
    iso_key_ring_close(door->ring);
}

static int teardown(void **state)
{
    struct doors *doors = *state;
    void *directory = doors->directory;
    close_door(&doors->here);
    close_door(&doors->there);
    free(doors);
    return scratch_teardown(&directory);
}

static void add(struct door *door, const char *name, int face)
{
    struct iso_person person = {.enrolled_s = 1000 + face, .valid_from_s = 3, .valid_until_s = 9};
    const struct iso_template tmpl = puppet_template(face, PUPPET_ALGORITHM);
    (void)snprintf(person.name, sizeof person.name, "%s", name);
    assert_int_equal(iso_gallery_add(door->gallery, &person, &tmpl, NULL), 0);
}

static uint8_t *write_file(struct door *door, const char *const *people,
                           const struct iso_transfer_lock *lock, size_t *size, size_t wanted)
{
    uint8_t *bytes = NULL;
    size_t n = 99;
    struct iso_fault fault = {.text = ""};
    if (iso_transfer_write(door->gallery, people, door->ring, lock, NULL, &bytes, size, &n,
                           &fault)) {
        fail_msg("%s", fault.text);
    }
    assert_int_equal(n, wanted);
    return bytes;
}

/* Reads a file and imports its people. Returns the first error. */
static int take(struct door *door, const uint8_t *bytes, size_t size,
                const struct iso_seal_key *key, const char *sender, bool replace, size_t *added,
                struct iso_fault *fault)
{
    struct iso_transfer *transfer = NULL;
    size_t n = 0;
    int error = iso_transfer_read(bytes, size, door->ring, key, sender, &transfer, fault);
    if (!error) {
        const struct iso_gallery_item *items = iso_transfer_items(transfer, &n);
        error = iso_gallery_import(door->gallery, items, n, replace, NULL, added, fault);
    }
    iso_transfer_done(transfer);
    return error;
}

static void expect_person(const struct door *door, const char *name, unsigned templates, int face)
{
    const struct iso_person *person = iso_gallery_find(door->gallery, name);
    assert_non_null(person);
    assert_int_equal(person->usable, templates);
    assert_int_equal(person->enrolled_s, 1000 + face);
    assert_int_equal(person->valid_from_s, 3);
    assert_int_equal(person->valid_until_s, 9);
    const struct iso_candidate_list own = iso_gallery_only(door->gallery, person->id);
    assert_int_equal(own.n_entries, templates);
    assert_int_equal(puppet_face_of(own.entries[0].tmpl), face);
}

static void carries_people_by_passphrase(void **state)
{
    struct doors *doors = *state;
    size_t size = 0, added = 0;
    add(&doors->here, "anna", 20);
    add(&doors->here, "bob", 60);
    add(&doors->here, "anna", 21);
    uint8_t *file = write_file(&doors->here, NULL, &doors->lock, &size, 2);
    assert_null(memmem(file, size, "anna", 4));
    assert_null(memmem(file, size, "ISOT\1", 5));
    assert_int_equal(take(&doors->there, file, size, &doors->lock.key, NULL, false, &added, NULL),
                     0);
    assert_int_equal(added, 2);
    expect_person(&doors->there, "anna", 2, 20);
    expect_person(&doors->there, "bob", 1, 60);
    /* A second import finds that they are known. */
    assert_int_equal(
        take(&doors->there, file, size, &doors->lock.key, doors->here.address, false, &added, NULL),
        0);
    assert_int_equal(added, 0);
    iso_transfer_free(file, size);
}

static void carries_one_person_to_one_appliance(void **state)
{
    static const char *const bob[] = {"bob", NULL}, *const eve[] = {"eve", NULL};
    struct doors *doors = *state;
    struct iso_fault fault = {.text = ""};
    const struct iso_transfer_lock lock = {.address = doors->there.address};
    size_t size = 0, added = 0, n = 0;
    uint8_t *file = NULL;
    add(&doors->here, "anna", 20);
    add(&doors->here, "bob", 60);
    assert_int_equal(iso_transfer_write(doors->here.gallery, eve, doors->here.ring, &lock, NULL,
                                        &file, &size, &n, NULL),
                     -ENOENT);
    file = write_file(&doors->here, bob, &lock, &size, 1);
    assert_int_equal(take(&doors->there, file, size, NULL, NULL, false, &added, &fault), -EINVAL);
    assert_non_null(strstr(fault.text, "needs the sender's address"));
    assert_int_equal(
        take(&doors->there, file, size, NULL, doors->there.address, false, &added, &fault),
        -EKEYREJECTED);
    assert_non_null(strstr(fault.text, "another appliance has signed the file"));
    assert_int_equal(
        take(&doors->here, file, size, NULL, doors->here.address, false, &added, &fault),
        -EKEYREJECTED);
    assert_non_null(strstr(fault.text, "the file is for another appliance"));
    assert_int_equal(
        take(&doors->there, file, size, NULL, doors->here.address, false, &added, NULL), 0);
    assert_int_equal(added, 1);
    expect_person(&doors->there, "bob", 1, 60);
    assert_null(iso_gallery_find(doors->there.gallery, "anna"));
    iso_transfer_free(file, size);
}

static void replaces_people_on_request(void **state)
{
    struct doors *doors = *state;
    size_t size = 0, added = 0;
    add(&doors->here, "anna", 20);
    add(&doors->there, "anna", 90);
    uint8_t *file = write_file(&doors->here, NULL, &doors->lock, &size, 1);
    assert_int_equal(take(&doors->there, file, size, &doors->lock.key, NULL, false, &added, NULL),
                     0);
    expect_person(&doors->there, "anna", 1, 90);
    assert_int_equal(take(&doors->there, file, size, &doors->lock.key, NULL, true, &added, NULL),
                     0);
    assert_int_equal(added, 1);
    expect_person(&doors->there, "anna", 1, 20);
    iso_transfer_free(file, size);
}

static void takes_all_or_none(void **state)
{
    struct doors *doors = *state;
    struct iso_fault fault = {.text = ""};
    size_t size = 0, added = 77, n = 0;
    add(&doors->here, "anna", 20);
    add(&doors->here, "bob", 60);
    add(&doors->there, "eve", 100);
    add(&doors->there, "zac", 140);
    uint8_t *file = write_file(&doors->here, NULL, &doors->lock, &size, 2);
    assert_int_equal(take(&doors->there, file, size, &doors->lock.key, NULL, false, &added, &fault),
                     -EDQUOT);
    assert_string_equal(fault.text, "the gallery is full: it holds 3 people, not 4");
    assert_int_equal(added, 77);
    (void)iso_gallery_people(doors->there.gallery, &n);
    assert_int_equal(n, 2);
    expect_person(&doors->there, "eve", 1, 100);
    iso_transfer_free(file, size);
}

static void refuses_changed_files(void **state)
{
    struct doors *doors = *state;
    size_t size = 0, added = 0;
    struct iso_fault fault = {.text = ""};
    struct iso_seal_key wrong = doors->lock.key;
    add(&doors->here, "anna", 20);
    uint8_t *file = write_file(&doors->here, NULL, &doors->lock, &size, 1);
    for (size_t at = 0; at < size; at += at < 160 ? 1 : 97) {
        file[at] ^= 0x40;
        const int error = take(&doors->there, file, size, &doors->lock.key, NULL, false, &added,
                               NULL);
        if (error != -EBADMSG) {
            fail_msg("byte %zu: %d", at, error);
        }
        file[at] ^= 0x40;
    }
    for (size_t length = 0; length < size; length += 61) {
        assert_int_equal(
            take(&doors->there, file, length, &doors->lock.key, NULL, false, &added, NULL),
            -EBADMSG);
    }
    wrong.bytes[0] ^= 1;
    assert_int_equal(take(&doors->there, file, size, &wrong, NULL, false, &added, &fault),
                     -EKEYREJECTED);
    assert_string_equal(fault.text, "import: the passphrase is wrong");
    assert_int_equal(take(&doors->there, file, size, NULL, NULL, false, &added, &fault), -EINVAL);
    assert_string_equal(fault.text, "import: the file needs a passphrase");
    iso_transfer_free(file, size);
}

static void refuses_wrong_addresses(void **state)
{
    static const char *const bad[] = {"", "12", "not an address"};
    struct doors *doors = *state;
    size_t size = 0, n = 0;
    uint8_t *file = NULL;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        const struct iso_transfer_lock lock = {.address = bad[i]};
        assert_int_equal(iso_transfer_write(doors->here.gallery, NULL, doors->here.ring, &lock,
                                            NULL, &file, &size, &n, NULL),
                         -EINVAL);
    }
    assert_null(file);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, setup, teardown)
    const struct CMUnitTest tests[] = {
        TEST(carries_people_by_passphrase), TEST(carries_one_person_to_one_appliance),
        TEST(replaces_people_on_request),   TEST(takes_all_or_none),
        TEST(refuses_changed_files),        TEST(refuses_wrong_addresses),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
