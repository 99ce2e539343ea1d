/* The changes of a fleet in the gallery: several people and a record in one transaction, in memory
 * and over a start. */
#include <errno.h>
#include <stdio.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/gallery/gallery.h"
#include "tests/firmware/rigs/gallery_rig.h"
#include "tests/firmware/rigs/puppets.h"

/* The bytes of the templates of one change. */
struct bytes {
    uint8_t bytes[2][ISO_TEMPLATE_BYTES_MAX];
};

static void put_template(struct iso_gallery_change *change, struct bytes *bytes, int face,
                         uint32_t algorithm)
{
    const struct iso_template tmpl = puppet_template(face, algorithm);
    const size_t i = change->item.n++;
    const int size = iso_template_serialise(&tmpl, bytes->bytes[i], sizeof bytes->bytes[i]);
    assert_true(size > 0);
    change->item.templates[i].algorithm = algorithm;
    change->item.templates[i].bytes = bytes->bytes[i];
    change->item.templates[i].size = (size_t)size;
}

static struct iso_gallery_change change_of(int64_t person, const char *name, const char *access)
{
    struct iso_gallery_change change = {
        .person = person, .access = access, .access_size = strlen(access)};
    snprintf(change.item.person.name, sizeof change.item.person.name, "%s", name);
    change.item.person.enrolled_s = 500;
    return change;
}

static int64_t id_of(struct iso_gallery *gallery, const char *name)
{
    const struct iso_person *person = iso_gallery_find(gallery, name);
    return person ? person->id : 0;
}

static void expect_record(struct iso_gallery *gallery, int64_t id, const char *text)
{
    size_t size = 0;
    const void *bytes = iso_gallery_access(gallery, id, &size);
    assert_int_equal(size, strlen(text));
    if (size) {
        assert_memory_equal(bytes, text, size);
    }
}

static struct iso_gallery *reopen(const char *directory, struct iso_gallery *gallery)
{
    iso_gallery_close(gallery);
    return gallery_rig_open(directory);
}

/* Whom a search compares with this face; 0: nobody. */
static int64_t found(struct iso_gallery *gallery, int face)
{
    const struct iso_candidate_list list = iso_gallery_everybody(gallery);
    for (int i = 0; i < list.n_entries; i++) {
        if (puppet_face_of(list.entries[i].tmpl) == face) {
            return list.entries[i].person;
        }
    }
    return 0;
}

static void a_person_and_a_record_come_together(void **state)
{
    struct iso_gallery *gallery = gallery_rig_open(*state);
    struct bytes bytes;
    struct iso_gallery_change change = change_of(0, "ada", "credential");
    put_template(&change, &bytes, 20, PUPPET_ALGORITHM);
    put_template(&change, &bytes, 21, PUPPET_ALGORITHM + 1);
    assert_int_equal(iso_gallery_stage(gallery, ISO_GALLERY_FLEET, "place 1", 7, NULL), 0);
    assert_int_equal(iso_gallery_apply(gallery, &change, 1, NULL), 0);
    const uint64_t changes = iso_gallery_version(gallery).changes;
    for (int round = 0; round < 2; round++) {
        const struct iso_person *ada = iso_gallery_find(gallery, "ada");
        assert_non_null(ada);
        assert_int_equal(ada->id, change.number);
        assert_int_equal(ada->templates, 2);
        assert_int_equal(ada->usable, 1);
        assert_int_equal(ada->enrolled_s, 500);
        assert_int_equal(found(gallery, 20), ada->id);
        assert_int_equal(found(gallery, 21), 0);
        expect_record(gallery, ada->id, "credential");
        expect_record(gallery, ISO_GALLERY_FLEET, "place 1");
        assert_int_equal(iso_gallery_version(gallery).changes, changes);
        gallery = reopen(*state, gallery);
    }
    iso_gallery_close(gallery);
}

static void a_person_is_replaced_by_number(void **state)
{
    struct iso_gallery *gallery = gallery_rig_open(*state);
    struct bytes bytes;
    assert_int_equal(gallery_rig_add(gallery, "ada", 20, NULL), 0);
    assert_int_equal(gallery_rig_add(gallery, "ben", 40, NULL), 0);
    const int64_t ada = id_of(gallery, "ada"), ben = id_of(gallery, "ben");
    struct iso_gallery_change change = change_of(ada, "ada lovelace", "one");
    change.keep = true;
    change.item.person.valid_until_s = 9000;
    assert_int_equal(iso_gallery_apply(gallery, &change, 1, NULL), 0);
    for (int round = 0; round < 2; round++) { /* the templates stay, and the number */
        const struct iso_person *person = iso_gallery_find(gallery, "ada lovelace");
        assert_int_equal(person->id, ada);
        assert_int_equal(person->usable, 1);
        assert_int_equal(person->valid_until_s, 9000);
        assert_null(iso_gallery_find(gallery, "ada"));
        assert_int_equal(found(gallery, 20), ada);
        expect_record(gallery, ada, "one");
        gallery = reopen(*state, gallery);
    }
    change = change_of(ada, "ada lovelace", "");
    put_template(&change, &bytes, 60, PUPPET_ALGORITHM);
    assert_int_equal(iso_gallery_apply(gallery, &change, 1, NULL), 0);
    for (int round = 0; round < 2; round++) {
        assert_true(change.number > ben);
        assert_int_equal(id_of(gallery, "ada lovelace"), change.number);
        assert_int_equal(found(gallery, 60), change.number);
        assert_int_equal(found(gallery, 20), 0);
        assert_int_equal(found(gallery, 40), ben);
        expect_record(gallery, change.number, "");
        gallery = reopen(*state, gallery);
    }
    change = (struct iso_gallery_change){.person = change.number, .remove = true};
    assert_int_equal(iso_gallery_apply(gallery, &change, 1, NULL), 0);
    for (int round = 0; round < 2; round++) {
        assert_int_equal(id_of(gallery, "ada lovelace"), 0);
        assert_int_equal(found(gallery, 60), 0);
        assert_int_equal(found(gallery, 40), ben);
        gallery = reopen(*state, gallery);
    }
    iso_gallery_close(gallery);
}

/* Ada and Ben exchange their names. */
static void names_are_exchanged_in_one_call(void **state)
{
    struct iso_gallery *gallery = gallery_rig_open(*state);
    assert_int_equal(gallery_rig_add(gallery, "ada", 20, NULL), 0);
    assert_int_equal(gallery_rig_add(gallery, "ben", 40, NULL), 0);
    const int64_t ada = id_of(gallery, "ada"), ben = id_of(gallery, "ben");
    struct iso_gallery_change changes[2] = {change_of(ada, "ben", ""), change_of(ben, "ada", "")};
    changes[0].keep = changes[1].keep = true;
    assert_int_equal(iso_gallery_apply(gallery, changes, 1, NULL), -EEXIST);
    assert_int_equal(iso_gallery_apply(gallery, changes, 2, NULL), 0);
    for (int round = 0; round < 2; round++) {
        assert_int_equal(id_of(gallery, "ben"), ada);
        assert_int_equal(id_of(gallery, "ada"), ben);
        gallery = reopen(*state, gallery);
    }
    changes[0] = change_of(ada, "ada", "");
    changes[1] = change_of(ben, "Ada", "");
    changes[0].keep = changes[1].keep = true;
    assert_int_equal(iso_gallery_apply(gallery, changes, 2, NULL), -EINVAL);
    assert_int_equal(id_of(gallery, "ben"), ada);
    iso_gallery_close(gallery);
}

static void expect_as_before(struct iso_gallery *gallery, uint64_t changes)
{
    assert_int_equal(iso_gallery_version(gallery).changes, changes);
    assert_int_equal(id_of(gallery, "carl"), 0);
    assert_int_equal(found(gallery, 80), 0);
    expect_record(gallery, ISO_GALLERY_FLEET, "before");
}

/* One change of two is refused: nothing of the call is stored, and the record waits. */
static void a_call_that_is_refused_changes_nothing(void **state)
{
    struct iso_gallery *gallery = gallery_rig_open(*state);
    struct bytes bytes;
    struct iso_gallery_change changes[2] = {change_of(0, "carl", "x"), change_of(0, "dora", "x")};
    assert_int_equal(gallery_rig_add(gallery, "ada", 20, NULL), 0);
    assert_int_equal(iso_gallery_set_access(gallery, ISO_GALLERY_FLEET, "before", 6, NULL), 0);
    const uint64_t before = iso_gallery_version(gallery).changes;
    put_template(&changes[0], &bytes, 80, PUPPET_ALGORITHM);
    assert_int_equal(iso_gallery_stage(gallery, ISO_GALLERY_FLEET, "after", 5, NULL), 0);
    changes[1].keep = true; /* nobody has templates that could stay */
    assert_int_equal(iso_gallery_apply(gallery, changes, 2, NULL), -EINVAL);
    expect_as_before(gallery, before);
    changes[1] = change_of(0, "CARL", "x");
    changes[1].item.n = 1;
    changes[1].item.templates[0] = changes[0].item.templates[0];
    assert_int_equal(iso_gallery_apply(gallery, changes, 2, NULL), -EINVAL); /* one name */
    expect_as_before(gallery, before);
    changes[1] = change_of(77, "dora", "x");
    assert_int_equal(iso_gallery_apply(gallery, changes, 2, NULL), -ENOENT);
    expect_as_before(gallery, before);
    bytes.bytes[0][0] ^= 1;
    assert_int_equal(iso_gallery_apply(gallery, changes, 1, NULL), -EINVAL);
    expect_as_before(gallery, before);
    iso_gallery_unstage(gallery);
    assert_int_equal(iso_gallery_apply(gallery, NULL, 0, NULL), 0);
    expect_as_before(gallery, before + 1);
    iso_gallery_close(gallery);
}

static void somebody_may_have_no_template(void **state)
{
    struct iso_gallery *gallery = gallery_rig_open(*state);
    struct bytes bytes;
    struct iso_gallery_change change = change_of(0, "carl", "card");
    assert_int_equal(iso_gallery_apply(gallery, &change, 1, NULL), 0);
    gallery = reopen(*state, gallery);
    assert_int_equal(iso_gallery_find(gallery, "carl")->templates, 0);
    change = change_of(id_of(gallery, "carl"), "carl", "card");
    put_template(&change, &bytes, 80, PUPPET_ALGORITHM);
    assert_int_equal(iso_gallery_apply(gallery, &change, 1, NULL), 0);
    assert_int_equal(found(gallery, 80), id_of(gallery, "carl"));
    change = change_of(id_of(gallery, "carl"), "carl", "card");
    assert_int_equal(iso_gallery_apply(gallery, &change, 1, NULL), 0);
    assert_int_equal(found(gallery, 80), 0);
    expect_record(gallery, id_of(gallery, "carl"), "card");
    iso_gallery_close(gallery);
}

static void a_full_gallery_takes_nobody_new(void **state)
{
    struct iso_gallery *gallery = gallery_rig_open(*state);
    struct bytes bytes;
    for (int i = 0; i < gallery_rig_capacity; i++) {
        assert_int_equal(gallery_rig_add_number(gallery, i, NULL), 0);
    }
    struct iso_gallery_change changes[2] = {change_of(0, "new", "")};
    put_template(&changes[0], &bytes, 80, PUPPET_ALGORITHM);
    assert_int_equal(iso_gallery_apply(gallery, changes, 1, NULL), -EDQUOT);
    changes[1] = (struct iso_gallery_change){.person = id_of(gallery, "person 1"), .remove = true};
    assert_int_equal(iso_gallery_apply(gallery, changes, 2, NULL), 0);
    gallery = reopen(*state, gallery);
    assert_int_equal(found(gallery, 80), id_of(gallery, "new"));
    iso_gallery_close(gallery);
}

static void the_record_also_goes_with_another_record(void **state)
{
    struct iso_gallery *gallery = gallery_rig_open(*state);
    assert_int_equal(iso_gallery_stage(gallery, ISO_GALLERY_FLEET, "old", 3, NULL), 0);
    assert_int_equal(iso_gallery_stage(gallery, ISO_GALLERY_FLEET, "place 2", 7, NULL), 0);
    assert_int_equal(iso_gallery_set_access(gallery, ISO_GALLERY_SITE, "policy", 6, NULL), 0);
    expect_record(gallery, ISO_GALLERY_FLEET, "place 2");
    assert_int_equal(iso_gallery_rotate(gallery, NULL, NULL), 0);
    gallery = reopen(*state, gallery);
    expect_record(gallery, ISO_GALLERY_FLEET, "place 2");
    expect_record(gallery, ISO_GALLERY_SITE, "policy");
    assert_int_equal(iso_gallery_stage(gallery, ISO_GALLERY_FLEET, NULL, 0, NULL), 0);
    assert_int_equal(iso_gallery_apply(gallery, NULL, 0, NULL), 0);
    gallery = reopen(*state, gallery);
    expect_record(gallery, ISO_GALLERY_FLEET, "");
    iso_gallery_close(gallery);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, stores_setup, stores_teardown)
    const struct CMUnitTest tests[] = {
        TEST(a_person_and_a_record_come_together),
        TEST(a_person_is_replaced_by_number),
        TEST(names_are_exchanged_in_one_call),
        TEST(a_call_that_is_refused_changes_nothing),
        TEST(somebody_may_have_no_template),
        TEST(a_full_gallery_takes_nobody_new),
        TEST(the_record_also_goes_with_another_record),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
