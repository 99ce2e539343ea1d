/* The counter in a TPM, tested on a software TPM. The test uses the TPM software stack directly for
 * actions that only the owner of a TPM may do. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <string.h>
#include <tss2/tss2_esys.h>
#include <tss2/tss2_tctildr.h>

#include "drivers/counter/tpm2_counter.h"
#include "tests/support/devices/soft_tpm.h"
#include "tests/support/programs/private_bus.h"
#include "tests/support/scratch.h"

enum { INDEX = 0x01804953 };

static struct soft_tpm tpm;

static int setup(void **state)
{
    const int error = scratch_setup(state);
    assert_int_equal(error, 0);
    return soft_tpm_start(&tpm, *state) ? 0 : -1;
}

static int teardown(void **state)
{
    soft_tpm_off(&tpm);
    return scratch_teardown(state);
}

static struct iso_counter open_counter(void)
{
    struct iso_counter counter = {0};
    struct iso_fault fault = {.text = ""};
    if (iso_tpm2_counter_open(tpm.tcti, INDEX, &counter, &fault)) {
        fail_msg("%s", fault.text);
    }
    return counter;
}

typedef int operation(void *self, uint64_t *value, struct iso_fault *fault);

static uint64_t value_of(operation *call, const struct iso_counter *counter)
{
    struct iso_fault fault = {.text = ""};
    uint64_t value = 0;
    if (call(counter->self, &value, &fault)) {
        fail_msg("%s", fault.text);
    }
    assert_string_equal(fault.text, "");
    return value;
}

static void expect_fault(operation *call, const struct iso_counter *counter, int error,
                         enum iso_fault_code code, const char *words)
{
    struct iso_fault fault = {.text = ""};
    uint64_t value = 77;
    assert_int_equal(call(counter->self, &value, &fault), error);
    assert_int_equal(value, 77);
    if (!strstr(fault.text, words)) {
        fail_msg("'%s' is not in: %s", words, fault.text);
    }
    assert_int_equal(fault.code, code);
}

/* ---- as the TPM's owner ---- */

static ESYS_CONTEXT *open_owner(TSS2_TCTI_CONTEXT **tcti)
{
    ESYS_CONTEXT *owner = NULL;
    assert_int_equal(Tss2_TctiLdr_Initialize(tpm.tcti, tcti), 0);
    assert_int_equal(Esys_Initialize(&owner, *tcti, NULL), 0);
    return owner;
}

static void close_owner(ESYS_CONTEXT *owner, TSS2_TCTI_CONTEXT *tcti)
{
    Esys_Finalize(&owner);
    Tss2_TctiLdr_Finalize(&tcti);
}

static void delete_index(void)
{
    TSS2_TCTI_CONTEXT *tcti = NULL;
    ESYS_CONTEXT *owner = open_owner(&tcti);
    ESYS_TR index = ESYS_TR_NONE;
    assert_int_equal(
        Esys_TR_FromTPMPublic(owner, INDEX, ESYS_TR_NONE, ESYS_TR_NONE, ESYS_TR_NONE, &index), 0);
    assert_int_equal(Esys_NV_UndefineSpace(owner, ESYS_TR_RH_OWNER, index, ESYS_TR_PASSWORD,
                                           ESYS_TR_NONE, ESYS_TR_NONE),
                     0);
    close_owner(owner, tcti);
}

static void make_index(TPMA_NV attributes)
{
    TSS2_TCTI_CONTEXT *tcti = NULL;
    ESYS_CONTEXT *owner = open_owner(&tcti);
    ESYS_TR index = ESYS_TR_NONE;
    const TPM2B_AUTH none = {.size = 0};
    const TPM2B_NV_PUBLIC public = {
        .nvPublic = {
            .nvIndex = INDEX, .nameAlg = TPM2_ALG_SHA256, .attributes = attributes, .dataSize = 8}};
    assert_int_equal(Esys_NV_DefineSpace(owner, ESYS_TR_RH_OWNER, ESYS_TR_PASSWORD, ESYS_TR_NONE,
                                         ESYS_TR_NONE, &none, &public, &index),
                     0);
    close_owner(owner, tcti);
}

static void set_password(void)
{
    TSS2_TCTI_CONTEXT *tcti = NULL;
    ESYS_CONTEXT *owner = open_owner(&tcti);
    const TPM2B_AUTH password = {.size = 4, .buffer = "word"};
    assert_int_equal(Esys_HierarchyChangeAuth(owner, ESYS_TR_RH_OWNER, ESYS_TR_PASSWORD,
                                              ESYS_TR_NONE, ESYS_TR_NONE, &password),
                     0);
    close_owner(owner, tcti);
}

/* ---- tests ---- */

static void it_is_made_and_counts(void **state)
{
    (void)state;
    struct iso_counter counter = open_counter();
    assert_string_equal(counter.ops->name, "tpm2");
    expect_fault(counter.ops->read, &counter, -ENOENT, ISO_FAULT_COUNTER_GONE,
                 "has no counter 0x01804953");
    expect_fault(counter.ops->increment, &counter, -ENOENT, ISO_FAULT_COUNTER_GONE,
                 "has no counter 0x01804953");
    const uint64_t first = value_of(counter.ops->define, &counter);
    assert_int_equal(value_of(counter.ops->read, &counter), first);
    for (uint64_t i = 1; i <= 20; i++) {
        assert_int_equal(value_of(counter.ops->increment, &counter), first + i);
    }
    iso_counter_close(&counter);
    assert_null(counter.ops);
    soft_tpm_off(&tpm); /* like a power cut */
    soft_tpm_on(&tpm);
    counter = open_counter();
    assert_int_equal(value_of(counter.ops->read, &counter), first + 20);
    iso_counter_close(&counter);
}

static void a_new_counter_begins_above_the_old_one(void **state)
{
    (void)state;
    struct iso_counter counter = open_counter();
    (void)value_of(counter.ops->define, &counter);
    for (int i = 0; i < 9; i++) {
        (void)value_of(counter.ops->increment, &counter);
    }
    const uint64_t last = value_of(counter.ops->read, &counter);
    iso_counter_close(&counter);
    delete_index();
    counter = open_counter();
    expect_fault(counter.ops->read, &counter, -ENOENT, ISO_FAULT_COUNTER_GONE, "has no counter");
    assert_true(value_of(counter.ops->define, &counter) > last);
    iso_counter_close(&counter);
}

/* Simulates a kill between the creation and the first increment. */
static void a_counter_that_never_counted_is_accepted(void **state)
{
    (void)state;
    make_index(TPMA_NV_AUTHREAD | TPMA_NV_AUTHWRITE | TPM2_NT_COUNTER << TPMA_NV_TPM2_NT_SHIFT);
    struct iso_counter counter = open_counter();
    expect_fault(counter.ops->read, &counter, -ENOENT, ISO_FAULT_COUNTER_GONE, "has no counter");
    const uint64_t first = value_of(counter.ops->define, &counter);
    assert_int_equal(value_of(counter.ops->read, &counter), first);
    iso_counter_close(&counter);
}

static void another_use_of_the_index_is_refused(void **state)
{
    static const TPMA_NV others[] = {
        TPMA_NV_AUTHREAD | TPMA_NV_AUTHWRITE, /* eight bytes that anybody may write */
        TPMA_NV_OWNERREAD | TPMA_NV_OWNERWRITE | TPM2_NT_COUNTER << TPMA_NV_TPM2_NT_SHIFT,
        TPMA_NV_AUTHREAD | TPMA_NV_AUTHWRITE |
            TPMA_NV_ORDERLY | /* its value jumps when power is lost */
            TPM2_NT_COUNTER << TPMA_NV_TPM2_NT_SHIFT,
    };
    (void)state;
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        make_index(others[i]);
        struct iso_counter counter = open_counter();
        expect_fault(counter.ops->read, &counter, -EBADMSG, ISO_FAULT_COUNTER_UNFIT,
                     "not as a usable counter");
        expect_fault(counter.ops->define, &counter, -EBADMSG, ISO_FAULT_COUNTER_UNFIT,
                     "index 0x01804953 is in use");
        expect_fault(counter.ops->increment, &counter, -EBADMSG, ISO_FAULT_COUNTER_UNFIT,
                     "is in use");
        iso_counter_close(&counter);
        delete_index();
    }
}

static void an_owner_with_a_password_is_reported(void **state)
{
    (void)state;
    set_password();
    struct iso_counter counter = open_counter();
    expect_fault(counter.ops->define, &counter, -EACCES, ISO_FAULT_TPM_DENIED, "cannot be made");
    iso_counter_close(&counter);
}

static void a_tpm_that_was_off_is_opened_again(void **state)
{
    (void)state;
    struct iso_counter counter = open_counter();
    const uint64_t first = value_of(counter.ops->define, &counter);
    soft_tpm_off(&tpm);
    expect_fault(counter.ops->increment, &counter, -EIO, ISO_FAULT_TPM_FAILED, "the TPM at swtpm:");
    expect_fault(counter.ops->increment, &counter, -EIO, ISO_FAULT_TPM_FAILED, "cannot be reached");
    soft_tpm_on(&tpm);
    assert_int_equal(value_of(counter.ops->increment, &counter), first + 1);
    iso_counter_close(&counter);
}

static void a_missing_tpm_is_reported(void **state)
{
    struct iso_counter counter = {0};
    struct iso_fault fault = {.text = ""};
    (void)state;
    assert_int_equal(iso_tpm2_counter_open("device:/nonexistent/tpm", INDEX, &counter, &fault),
                     -EIO);
    assert_string_equal(fault.text,
                        "the TPM at device:/nonexistent/tpm: No such file or directory");
    assert_int_equal(fault.code, ISO_FAULT_TPM_MISSING);
    assert_int_equal(iso_tpm2_counter_open("device:/dev/null", INDEX, &counter, &fault), -EIO);
    assert_non_null(strstr(fault.text, "the TPM at device:/dev/null cannot be reached"));
    assert_int_equal(fault.code, ISO_FAULT_TPM_FAILED);
    assert_int_equal(iso_tpm2_counter_open("no-such-tcti:", INDEX, &counter, &fault), -EIO);
    assert_non_null(strstr(fault.text, "the TPM at no-such-tcti: cannot be reached"));
    assert_null(counter.ops);
}

static void an_index_outside_the_owners_range_is_refused(void **state)
{
    static const char *const bad[] = {"",           "x",           "0x1", "0x017fffff",
                                      "0x01c00000", "0x01800000 ", "-1",  "99999999999999999999"};
    struct iso_fault fault = {.text = ""};
    uint32_t index = 5;
    (void)state;
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_int_equal(iso_tpm2_index_parse(bad[i], &index, &fault), -EINVAL);
        assert_int_equal(index, 5);
    }
    assert_string_equal(fault.text, "'99999999999999999999' is not an index of the owner of a TPM: "
                                    "0x1800000 to 0x1bfffff");
    assert_int_equal(iso_tpm2_index_parse("0x01bfffff", &index, &fault), 0);
    assert_int_equal(index, 0x01bfffff);
    assert_int_equal(iso_tpm2_index_parse("25165824", &index, &fault), 0);
    assert_int_equal(index, 0x01800000);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, setup, teardown)
    const struct CMUnitTest with_tpm[] = {
        TEST(it_is_made_and_counts),
        TEST(a_new_counter_begins_above_the_old_one),
        TEST(a_counter_that_never_counted_is_accepted),
        TEST(another_use_of_the_index_is_refused),
        TEST(an_owner_with_a_password_is_reported),
        TEST(a_tpm_that_was_off_is_opened_again),
    };
    const struct CMUnitTest without[] = {
        cmocka_unit_test(a_missing_tpm_is_reported),
        cmocka_unit_test(an_index_outside_the_owners_range_is_refused),
    };
    void *directory = NULL;
    if (cmocka_run_group_tests(without, NULL, NULL)) {
        return 1;
    }
    if (scratch_setup(&directory)) {
        return 1;
    }
    const bool there = soft_tpm_start(&tpm, directory);
    soft_tpm_off(&tpm);
    (void)scratch_teardown(&directory);
    return there ? cmocka_run_group_tests(with_tpm, NULL, NULL) : TEST_SKIPPED;
}
