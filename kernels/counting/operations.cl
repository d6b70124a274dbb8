// operations.cl: where `koksma explain` counts the operations of a kernel that runs. Comes before everything else; the
// host has put a count beside every statement of the pieces (harness/plan/instrument.hpp). What has the size of a vector
// is an operation of all lanes; anything smaller is a scalar that all lanes share.
typedef struct {
  ulong at[KOKSMA_COUNTED_SLOTS * KOKSMA_COUNTED_OPERATIONS];
  uint slot;  // where the slot at work begins
} koksma_counted;

#define KOKSMA_COUNT_AS(which) (koksma_counting->slot = (which) * KOKSMA_COUNTED_OPERATIONS)
// sizeof does not evaluate the expression. Scalars have at most 8 bytes, vectors at least 16.
#define KOKSMA_COUNT(operation, expression) \
  koksma_counting->at[koksma_counting->slot + (sizeof(expression) > 8 ? (operation) : KOKSMA_COUNTED_SCALAR)] += 1
#define KOKSMA_COUNT_ELEMENT(operation, expression) \
  koksma_counting->at[koksma_counting->slot + (operation)] += sizeof(expression) <= 8
#define KOKSMA_COUNT_ALWAYS(operation) koksma_counting->at[koksma_counting->slot + (operation)] += 1
