#include "drivers/counter/tpm2_counter.h"

#include <errno.h>
#include <limits.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <tss2/tss2_esys.h>
#include <tss2/tss2_rc.h>
#include <tss2/tss2_tcti_device.h>
#include <tss2/tss2_tctildr.h>
#include <unistd.h>

enum { VALUE_BYTES = 8, REFUSED = 0x0bf, CODE = 0xffff };

static const TPMA_NV counter_attributes = TPMA_NV_AUTHREAD | TPMA_NV_AUTHWRITE | TPMA_NV_NO_DA |
                                          (TPM2_NT_COUNTER << TPMA_NV_TPM2_NT_SHIFT);

struct tpm2_counter {
    char *tcti_name;
    uint32_t index;
    TSS2_TCTI_CONTEXT *tcti;
    bool tcti_is_loaded; /* it was loaded by Tss2_TctiLdr_Initialize */
    ESYS_CONTEXT *esys;  /* NULL: the TPM is not open */
    ESYS_TR handle;      /* handle of the index; ESYS_TR_NONE until it is found */
};

/* ---- the TPM ---- */

/* Whether the TPM itself returned the code, directly or through a resource manager. */
static bool is_of_tpm(TSS2_RC rc)
{
    const TSS2_RC layer = rc & TSS2_RC_LAYER_MASK;
    return layer == TSS2_TPM_RC_LAYER || layer == TSS2_RESMGR_TPM_RC_LAYER;
}

/* Whether the TPM returned the code `expected`. A code of format one (TPM2_RC_FMT1) also has the
 * number of the handle, parameter or session that it concerns; these bits are not compared. */
static bool is_tpm_rc(TSS2_RC rc, TPM2_RC expected)
{
    const TPM2_RC code = rc & CODE;
    return is_of_tpm(rc) && (code & TPM2_RC_FMT1 ? (code & REFUSED) : code) == expected;
}

static void release_tpm(struct tpm2_counter *counter)
{
    if (counter->esys) {
        Esys_Finalize(&counter->esys);
    }
    if (counter->tcti && counter->tcti_is_loaded) {
        Tss2_TctiLdr_Finalize(&counter->tcti);
    } else if (counter->tcti) {
        Tss2_Tcti_Finalize(counter->tcti);
        free(counter->tcti);
        counter->tcti = NULL;
    }
    counter->handle = ESYS_TR_NONE;
}

/* Translates the code into a fault. If the TPM did not answer, the next call opens it again. */
static int refuse_rc(struct tpm2_counter *counter, TSS2_RC rc, const char *what,
                     struct iso_fault *fault)
{
    const bool password = is_tpm_rc(rc, TPM2_RC_BAD_AUTH) || is_tpm_rc(rc, TPM2_RC_AUTH_FAIL);
    const bool later = is_tpm_rc(rc, TPM2_RC_NV_RATE) || is_tpm_rc(rc, TPM2_RC_RETRY) ||
                       is_tpm_rc(rc, TPM2_RC_YIELDED) || is_tpm_rc(rc, TPM2_RC_TESTING);
    int error = later ? -EAGAIN : -EIO;
    if (password) {
        error = -EACCES;
    }
    (void)iso_fault_set_code(fault, password ? ISO_FAULT_TPM_DENIED : ISO_FAULT_TPM_FAILED, error,
                             "the TPM at %s: counter 0x%08x cannot be %s: %s", counter->tcti_name,
                             (unsigned)counter->index, what, Tss2_RC_Decode(rc));
    if (!is_of_tpm(rc)) {
        release_tpm(counter);
    }
    return error;
}

/* Opens a device without the loader, so that nothing has to be loaded after the process is
 * confined. */
static TSS2_RC open_device(struct tpm2_counter *counter, const char *path)
{
    size_t size = 0;
    TSS2_RC rc = Tss2_Tcti_Device_Init(NULL, &size, NULL);
    TSS2_TCTI_CONTEXT *tcti = rc ? NULL : calloc(1, size);
    if (!tcti) {
        return rc ? rc : TSS2_ESYS_RC_MEMORY;
    }
    rc = Tss2_Tcti_Device_Init(tcti, &size, path);
    if (rc) {
        free(tcti);
        return rc;
    }
    counter->tcti = tcti;
    counter->tcti_is_loaded = false;
    return 0;
}

static TSS2_RC open_tcti(struct tpm2_counter *counter)
{
    static const char device[] = "device:";
    if (strncmp(counter->tcti_name, device, strlen(device)) == 0) {
        return open_device(counter, counter->tcti_name + strlen(device));
    }
    counter->tcti_is_loaded = true;
    return Tss2_TctiLdr_Initialize(counter->tcti_name, &counter->tcti);
}

static enum iso_fault_code access_fault_code(int error)
{
    switch (error) {
    case ENOENT:
        return ISO_FAULT_TPM_MISSING;
    case EACCES:
        return ISO_FAULT_TPM_DENIED;
    default:
        return ISO_FAULT_TPM_FAILED;
    }
}

static int open_tpm(struct tpm2_counter *counter, struct iso_fault *fault)
{
    const char *path = strchr(counter->tcti_name, '/');
    if (counter->esys) {
        return 0;
    }
    /* The reason is found here, because the software stack does not report it. */
    if (strncmp(counter->tcti_name, "device:/", 8) == 0 && access(path, R_OK | W_OK)) {
        return iso_fault_set_code(fault, access_fault_code(errno), -EIO, "the TPM at %s: %m",
                                  counter->tcti_name);
    }
    TSS2_RC rc = open_tcti(counter);
    if (!rc) {
        rc = Esys_Initialize(&counter->esys, counter->tcti, NULL);
    }
    if (rc) {
        release_tpm(counter);
        return iso_fault_set_code(fault, ISO_FAULT_TPM_FAILED, -EIO,
                                  "the TPM at %s cannot be reached: %s", counter->tcti_name,
                                  Tss2_RC_Decode(rc));
    }
    return 0;
}

/* ---- the index ---- */

static int counter_absent(const struct tpm2_counter *counter, struct iso_fault *fault)
{
    return iso_fault_set_code(fault, ISO_FAULT_COUNTER_GONE, -ENOENT,
                              "the TPM at %s has no counter 0x%08x", counter->tcti_name,
                              (unsigned)counter->index);
}

/* An index that is used for another purpose is refused and stays as it is. */
static int check_index(struct tpm2_counter *counter, struct iso_fault *fault)
{
    const TPMA_NV least = counter_attributes & ~TPMA_NV_NO_DA;
    TPM2B_NV_PUBLIC *index = NULL;
    const TSS2_RC rc = Esys_NV_ReadPublic(counter->esys, counter->handle, ESYS_TR_NONE,
                                          ESYS_TR_NONE, ESYS_TR_NONE, &index, NULL);
    if (rc) {
        return refuse_rc(counter, rc, "looked at", fault);
    }
    const TPMA_NV found = index->nvPublic.attributes;
    Esys_Free(index);
    return (found & (least | TPMA_NV_TPM2_NT_MASK | TPMA_NV_ORDERLY)) == least
               ? 0
               : iso_fault_set_code(
                     fault, ISO_FAULT_COUNTER_UNFIT, -EBADMSG,
                     "the TPM at %s: index 0x%08x is in use, but not as a usable counter "
                     "(attributes 0x%08x)",
                     counter->tcti_name, (unsigned)counter->index, (unsigned)found);
}

/* The index may have been deleted since it was found, so every call looks for it again. */
static int find_index(struct tpm2_counter *counter, struct iso_fault *fault)
{
    const int error = open_tpm(counter, fault);
    if (error) {
        return error;
    }
    if (counter->handle != ESYS_TR_NONE) {
        (void)Esys_TR_Close(counter->esys, &counter->handle);
    }
    const TSS2_RC rc = Esys_TR_FromTPMPublic(counter->esys, counter->index, ESYS_TR_NONE,
                                             ESYS_TR_NONE, ESYS_TR_NONE, &counter->handle);
    if (rc) {
        counter->handle = ESYS_TR_NONE;
        return is_tpm_rc(rc, TPM2_RC_HANDLE) ? counter_absent(counter, fault)
                                             : refuse_rc(counter, rc, "found", fault);
    }
    return check_index(counter, fault);
}

static int read_value(struct tpm2_counter *counter, uint64_t *value, struct iso_fault *fault)
{
    TPM2B_MAX_NV_BUFFER *data = NULL;
    const TSS2_RC rc = Esys_NV_Read(counter->esys, counter->handle, counter->handle,
                                    ESYS_TR_PASSWORD, ESYS_TR_NONE, ESYS_TR_NONE, VALUE_BYTES, 0,
                                    &data);
    if (rc) {
        return is_tpm_rc(rc, TPM2_RC_NV_UNINITIALIZED) ? counter_absent(counter, fault)
                                                       : refuse_rc(counter, rc, "read", fault);
    }
    const bool whole = data->size == VALUE_BYTES;
    uint64_t found = 0;
    for (size_t i = 0; whole && i < VALUE_BYTES; i++) {
        found = found << 8 | data->buffer[i];
    }
    Esys_Free(data);
    if (!whole) {
        return refuse_rc(counter, TSS2_ESYS_RC_MALFORMED_RESPONSE, "read", fault);
    }
    *value = found;
    return 0;
}

static int raise_counter(struct tpm2_counter *counter, uint64_t *value, struct iso_fault *fault)
{
    const TSS2_RC rc = Esys_NV_Increment(counter->esys, counter->handle, counter->handle,
                                         ESYS_TR_PASSWORD, ESYS_TR_NONE, ESYS_TR_NONE);
    return rc ? refuse_rc(counter, rc, "raised", fault) : read_value(counter, value, fault);
}

static int make_index(struct tpm2_counter *counter, struct iso_fault *fault)
{
    const TPM2B_AUTH no_password = {.size = 0};
    const TPM2B_NV_PUBLIC index = {.nvPublic = {.nvIndex = counter->index,
                                                .nameAlg = TPM2_ALG_SHA256,
                                                .attributes = counter_attributes,
                                                .dataSize = VALUE_BYTES}};
    const TSS2_RC rc = Esys_NV_DefineSpace(counter->esys, ESYS_TR_RH_OWNER, ESYS_TR_PASSWORD,
                                           ESYS_TR_NONE, ESYS_TR_NONE, &no_password, &index,
                                           &counter->handle);
    return rc ? refuse_rc(counter, rc, "made", fault) : 0;
}

/* ---- operations ---- */

static int read_counter(void *self, uint64_t *value, struct iso_fault *fault)
{
    const int error = find_index(self, fault);
    return error ? error : read_value(self, value, fault);
}

static int define_counter(void *self, uint64_t *value, struct iso_fault *fault)
{
    struct iso_fault why = {.text = ""};
    int error = find_index(self, &why);
    if (error == -ENOENT) {
        error = make_index(self, fault);
    } else if (error) {
        (void)iso_fault_set_code(fault, why.code, error, "%s", why.text);
    }
    return error ? error : raise_counter(self, value, fault);
}

static int increment_counter(void *self, uint64_t *value, struct iso_fault *fault)
{
    const int error = find_index(self, fault);
    return error ? error : raise_counter(self, value, fault);
}

static void close_counter(void *self)
{
    struct tpm2_counter *counter = self;
    release_tpm(counter);
    free(counter->tcti_name);
    free(counter);
}

static const struct iso_counter_ops ops = {
    .name = "tpm2",
    .read = read_counter,
    .define = define_counter,
    .increment = increment_counter,
    .close = close_counter,
};

int iso_tpm2_counter_open(const char *tcti, uint32_t index, struct iso_counter *out,
                          struct iso_fault *fault)
{
    struct tpm2_counter *counter = calloc(1, sizeof *counter);
    if (!counter || !(counter->tcti_name = strdup(tcti))) {
        free(counter);
        return iso_fault_set(fault, -ENOMEM, "the TPM at %s: out of memory", tcti);
    }
    counter->index = index;
    counter->handle = ESYS_TR_NONE;
    const int error = open_tpm(counter, fault);
    if (error) {
        close_counter(counter);
        return error;
    }
    *out = (struct iso_counter){.ops = &ops, .self = counter};
    return 0;
}
