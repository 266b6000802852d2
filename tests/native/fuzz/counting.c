/* Counts the blocks of memory that the library holds: linked with --wrap=malloc and so on. */
#include <stddef.h>

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void __real_free(void *block);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void __wrap_free(void *block);
long live_blocks(void);

static long live;

void *__wrap_malloc(size_t size)
{
    void *block = __real_malloc(size);
    live += block != NULL;
    return block;
}

void *__wrap_calloc(size_t count, size_t size)
{
    void *block = __real_calloc(count, size);
    live += block != NULL;
    return block;
}

void __wrap_free(void *block)
{
    live -= block != NULL;
    __real_free(block);
}

__attribute__((visibility("default"))) long live_blocks(void)
{
    return live;
}
