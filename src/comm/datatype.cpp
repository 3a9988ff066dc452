#include "comm/datatype.hpp"

namespace packmpi::comm {

MPI_Datatype double_block(int count) {
  MPI_Datatype type = MPI_DATATYPE_NULL;
  MPI_Type_contiguous(count, MPI_DOUBLE, &type);
  MPI_Type_commit(&type);
  return type;
}

void free_type(MPI_Datatype& type) noexcept {
  if (type != MPI_DATATYPE_NULL) MPI_Type_free(&type);
}

}  // namespace packmpi::comm
