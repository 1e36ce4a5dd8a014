// OpenCASCADE behind plain functions: one surface, projections and grids.

#include <GeomAPI_ProjectPointOnSurf.hxx>
#include <Geom_BSplineSurface.hxx>
#include <ShapeAnalysis_Surface.hxx>
#include <Standard_Failure.hxx>
#include <TColStd_Array1OfInteger.hxx>
#include <TColStd_Array1OfReal.hxx>
#include <TColgp_Array2OfPnt.hxx>

namespace {
struct Occt {
  Handle(Geom_BSplineSurface) surface;
  Handle(ShapeAnalysis_Surface) analysis;
  GeomAPI_ProjectPointOnSurf projector;
  gp_Pnt2d last;
  double size;
};
}  // namespace

extern "C" {

// Distinct knots with multiplicities; points u-major.
void *occt_new(int rows, int columns, int p, int q, int nu, const double *u, const int *mu, int nv, const double *v,
               const int *mv, const double *points, double size) {
  try {
    TColgp_Array2OfPnt net(1, rows, 1, columns);
    for (int i = 0; i < rows; ++i)
      for (int j = 0; j < columns; ++j) {
        const double *x = points + 3 * (i * columns + j);
        net.SetValue(i + 1, j + 1, gp_Pnt(x[0], x[1], x[2]));
      }
    TColStd_Array1OfReal ku(1, nu), kv(1, nv);
    TColStd_Array1OfInteger nmu(1, nu), nmv(1, nv);
    for (int k = 0; k < nu; ++k) ku.SetValue(k + 1, u[k]), nmu.SetValue(k + 1, mu[k]);
    for (int k = 0; k < nv; ++k) kv.SetValue(k + 1, v[k]), nmv.SetValue(k + 1, mv[k]);
    Occt *made = new Occt;
    made->surface = new Geom_BSplineSurface(net, ku, kv, nmu, nmv, p, q);
    made->analysis = new ShapeAnalysis_Surface(made->surface);
    made->projector.Init(made->surface, u[0], u[nu - 1], v[0], v[nv - 1], 1e-9);
    made->size = size;
    return made;
  } catch (const Standard_Failure &) {
    return nullptr;
  }
}

void occt_free(void *it) { delete static_cast<Occt *>(it); }

// 1 when found; warm starts from the last answer.
int occt_closest(void *it, const double *q, int warm, double *out) {
  Occt *occt = static_cast<Occt *>(it);
  try {
    const gp_Pnt query(q[0], q[1], q[2]);
    gp_Pnt foot;
    if (warm) {
      occt->last = occt->analysis->NextValueOfUV(occt->last, query, 1e-9);
      foot = occt->surface->Value(occt->last.X(), occt->last.Y());
    } else {
      occt->projector.Perform(query);
      if (occt->projector.NbPoints() == 0) return 0;
      double a, b;
      occt->projector.LowerDistanceParameters(a, b);
      occt->last = gp_Pnt2d(a, b);
      foot = occt->projector.NearestPoint();
    }
    out[0] = foot.X(), out[1] = foot.Y(), out[2] = foot.Z();
    return 1;
  } catch (const Standard_Failure &) {
    return 0;
  }
}

void occt_grid(void *it, int m, const double *us, int n, const double *vs, double *points, double *normals) {
  Occt *occt = static_cast<Occt *>(it);
  for (int i = 0; i < m; ++i)
    for (int j = 0; j < n; ++j) {
      const int k = 3 * (i * n + j);
      gp_Pnt p;
      if (normals == nullptr) {
        occt->surface->D0(us[i], vs[j], p);
      } else {
        gp_Vec du, dv;
        occt->surface->D1(us[i], vs[j], p, du, dv);
        const gp_Vec across = du.Crossed(dv);
        const double length = across.Magnitude();
        for (int c = 0; c < 3; ++c) normals[k + c] = length > 0 ? across.Coord(c + 1) / length : 0.0;
      }
      for (int c = 0; c < 3; ++c) points[k + c] = p.Coord(c + 1);
    }
}
}
